# SPDX-License-Identifier: MIT
"""Skins, poses and skeletons, against NumPy."""
import numpy as np
import pytest
import sphmesh
from conftest import torus


def turned(axis, angle, shift=(0, 0, 0)):
    """A rotation and a translation, shape (3, 4)."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.c_[np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross, shift]


def applied(transforms, points):
    """Each (..., 3, 4) to each point of (n, 3): (..., n, 3)."""
    return points @ np.swapaxes(transforms[..., :3], -1, -2) + transforms[..., None, :, 3]


def linear(skin, transforms):
    moved = applied(transforms, skin.rest.astype(float))  # (poses, J, n, 3)
    picked = moved[:, skin.bones, np.arange(skin.vertex_count)[:, None]]
    return (picked * skin.weights[..., None]).sum(2)


@pytest.fixture(scope="module")
def arm():
    """Three spheres on a line; the third turns about the second, all move."""
    rest = np.random.default_rng(5).uniform([0, -0.2, -0.2], [4, 0.2, 0.2], (60, 3)).astype(np.float32)
    place = rest[:, 0] * 0.75
    bones = np.stack([np.minimum(place.astype(int), 2), np.minimum(place.astype(int) + 1, 2)], 1)
    weights = np.stack([1 - place % 1, place % 1], 1)
    still = [turned((0, 0, 1), 0, (0.1 * f, 0, 0)) for f in range(4)]
    bend = []
    for f in range(4):
        move = turned((0, 0, 1), 0.3 * f)
        move[:, 3] = [2 + 0.1 * f, 0, 0] - move[:, :3] @ [2, 0, 0]
        bend.append(move)
    transforms = np.stack([still, still, bend], 1)
    return sphmesh.Skin(rest, bones, weights, transforms, pivots=[[0, 0, 0], [2, 0, 0], [4, 0, 0]], radii=[1, 1, 1],
                        links=[[0, 1], [1, 2]], clips=[sphmesh.Clip("rise", 0, 1, 24), sphmesh.Clip("fäll", 1, 3)])


def test_a_skin_of_your_own_comes_back_in_order(arm):
    assert (arm.vertex_count, arm.bone_count, arm.influence_count, arm.frame_count) == (60, 3, 2, 4)
    assert arm.rigid and (np.diff(arm.weights, axis=1) <= 0).all() and (arm.weights.sum(1) == 1).all()
    assert arm.clips == [("rise", 0, 1, 24), ("fäll", 1, 3, 0)]
    assert arm.links.tolist() == [[0, 1], [1, 2]] and arm.radii.tolist() == [1, 1, 1]
    with pytest.raises(sphmesh.InvalidError, match="vertex 0"):
        sphmesh.Skin([[0, 0, 0]], [[0]], [[0.5]])
    with pytest.raises(ValueError, match="last row"):
        sphmesh.Skin([[0, 0, 0]], [[0]], [[1]], np.ones((1, 1, 4, 4)))


def test_poses_are_linear_blend_skinning(arm):
    expected = linear(arm, arm.transforms)
    deformer = arm.deformer()
    many = deformer.pose(arm.transforms)
    assert many.normals is None and np.allclose(many.positions, expected, atol=1e-5)
    square = np.concatenate([arm.transforms, np.broadcast_to([0, 0, 0, 1], (4, 3, 1, 4))], 2)
    out = np.empty((60, 3), np.float32)
    assert deformer.pose(square[2], out=out).positions is out and np.array_equal(out, many.positions[2])
    rigid = np.broadcast_to(turned((1, 2, 3), 1.1, (4, 5, 6)), (3, 3, 4))
    for method in ("linear", "dual_quaternion"):
        found = deformer.pose(rigid, method=method).positions
        assert np.allclose(found, applied(rigid[0], arm.rest.astype(float)), atol=1e-5)
    with pytest.raises(sphmesh.StateError):
        deformer.pose(arm.transforms, normals=True)  # there are neither triangles nor normals
    up = np.tile([0, 0, 1], (60, 1))
    assert np.allclose(arm.deformer(up).pose(rigid, normals=True).normals, rigid[0][:, 2], atol=1e-5)
    with pytest.raises(ValueError, match="shape"):
        deformer.pose(arm.transforms[:, :2])


def test_a_skeleton_says_the_same_pose_by_joints(arm):
    skeleton = arm.skeleton(root=0)
    assert skeleton.parents.tolist() == [sphmesh.NO_JOINT, 0, 1] and skeleton.order[0] == 0
    assert np.allclose(skeleton.positions[2], [2, 0, 0], atol=1e-6)  # the hinge
    assert skeleton.gaps.max() < 1e-6
    for pose in arm.transforms:
        local = skeleton.locals_of(pose)
        assert np.allclose(skeleton.transforms_of(local), pose, atol=1e-12)
    assert np.allclose(skeleton.locals_of(np.tile(np.eye(4)[:3], (3, 1, 1))), skeleton.rest, atol=1e-12)
    assert arm.skeleton(single_root=True).parents[3] == sphmesh.NO_JOINT
    assert (arm.skeleton(layout="flat").parents == sphmesh.NO_JOINT).all()
    assert np.allclose(skeleton.inverse_bind[2][:, 3], -skeleton.positions[2])


def test_spheres_that_move_as_one_body_turn_as_it(level, animation):
    skin = level.skin(animation, rounds=1)
    move = turned((1, -1, 2), 0.8, (1, 2, 3))
    found = skin.pose_from_spheres(applied(move, skin.pivots))
    assert np.allclose(found, move, atol=1e-9)
    again = skin.pose_from_spheres(skin.pivots, reference=np.tile(np.eye(4)[:3], (20, 1, 1)))
    assert np.allclose(again, np.eye(4)[:3], atol=1e-9)


def test_a_decomposition_is_as_good_as_it_says(level, animation):
    frames, _ = torus()
    skin = level.skin(animation, names=["stretch"], fps=24, mode="animation")
    overall, per_frame = skin.errors()
    off = np.linalg.norm(linear(skin, skin.transforms) - frames, axis=2)
    assert overall.rmse == pytest.approx(np.sqrt((off ** 2).mean()), rel=1e-4)
    assert np.allclose(per_frame["max"], off.max(axis=1), rtol=1e-3)
    assert overall.rmse_percent < 0.5
    assert skin.measure(animation)[0].rmse == pytest.approx(overall.rmse, rel=1e-6)
    assert skin.clips == [("stretch", 0, 4, 24)] and np.array_equal(skin.triangles, animation.triangles)


def test_what_is_locked_stays(level, animation):
    start = level.skin(animation, mode="geometric", rounds=1)
    locked = np.arange(288) < 40
    skin = level.skin(animation, mode="animation", rounds=2, initial=(start.bones, start.weights),
                      initial_transforms=start.transforms, locked_vertices=locked, locked_bones=np.arange(20) == 3)
    assert np.array_equal(skin.weights[locked], start.weights[locked])
    assert not np.array_equal(skin.weights[~locked], start.weights[~locked])
    assert np.allclose(skin.transforms[:, 3], start.transforms[:, 3], atol=1e-12)


def test_a_rig_goes_through_a_file(tmp_path, level, animation):
    skin = level.skin(animation, rounds=1, names=["stretch"], fps=30)
    skin.save(tmp_path / "rig.glb", skeleton=skin.skeleton())
    again = sphmesh.Skin.open(tmp_path / "rig.glb")
    assert again.clips == [("stretch", 0, 4, 30)] and again.bone_count == 20
    expected = skin.deformer().pose(skin.transforms).positions
    assert np.allclose(again.deformer().pose(again.transforms).positions, expected, atol=1e-5)
    rest = again.rest
    again.close()
    assert np.isfinite(rest).all()
