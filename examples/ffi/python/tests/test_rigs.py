# SPDX-License-Identifier: MIT
"""Simplified skins, and implicit skinning, against closed forms."""
import math

import numpy as np
import pytest
import sphmesh
from conftest import ball

RINGS, SIDES = 25, 16


def tube_skin(frames=4):
    """A closed tube along x, from 0 to 4, on two bones that meet at 2; the second turns up to a right angle about z."""
    x, a = np.meshgrid(np.linspace(0, 4, RINGS), np.arange(SIDES) * 2 * np.pi / SIDES, indexing="ij")
    rest = np.stack([x, 0.5 * np.cos(a), 0.5 * np.sin(a)], -1).reshape(-1, 3)
    rest = np.concatenate([rest, [[-0.1, 0, 0], [4.1, 0, 0]]])
    i = np.arange(RINGS * SIDES).reshape(RINGS, SIDES)
    j, first, last = np.roll(i, -1, 1), np.full(SIDES, len(rest) - 2), np.full(SIDES, len(rest) - 1)
    sheets = [(i[:-1], j[:-1], j[1:]), (i[:-1], j[1:], i[1:]), (first, j[0], i[0]), (last, i[-1], j[-1])]
    triangles = np.concatenate([np.stack(s, -1).reshape(-1, 3) for s in sheets])
    share = np.clip((rest[:, 0] - 1.5), 0, 1)
    transforms = np.tile(np.eye(4)[:3], (frames, 2, 1, 1))
    for f in range(frames):
        angle = math.pi / 2 * f / (frames - 1)
        c, s = math.cos(angle), math.sin(angle)
        transforms[f, 1] = [[c, -s, 0, 2 - 2 * c], [s, c, 0, -2 * s], [0, 0, 1, 0]]
    return sphmesh.Skin(rest, np.tile([0, 1], (len(rest), 1)), np.stack([1 - share, share], 1), transforms,
                        triangles=triangles, pivots=[[1, 0, 0], [3, 0, 0]], radii=[0.5, 0.5], links=[[0, 1]])


@pytest.fixture(scope="module")
def skin():
    return tube_skin()


@pytest.fixture(scope="module")
def implicit(skin):
    return skin.implicit()


def volume(points, triangles):
    a, b, c = (points[triangles[:, k]].astype(float) for k in range(3))
    return (np.cross(a, b) * c).sum() / 6


def test_levels_of_a_skin_have_the_sizes_that_are_asked_for(skin):
    levels = skin.simplified(pose_limit=0)
    assert levels.pose_count == 4 and levels.bounding_diagonal > 4
    input = levels.describe(0)
    assert (input.vertex_count, input.triangle_count, input.error) == (402, 800, 0)
    told = [levels.describe(c) for c in range(levels.collapse_count + 1)]
    assert (np.diff([t.error for t in told]) >= 0).all() and (np.diff([t.triangle_count for t in told]) <= 0).all()
    for count in (600, 200, 60):
        level = levels.find(triangles=count)
        assert told[level].triangle_count <= count < told[level - 1].triangle_count
        coarse = levels.skin(triangles=count)
        assert len(coarse.triangles) == told[level].triangle_count and coarse.vertex_count == told[level].vertex_count
        assert np.array_equal(coarse.transforms, skin.transforms)
    assert told[levels.find(vertices=100)].vertex_count == 100
    fine = levels.find(error=0.001 * levels.bounding_diagonal)
    assert told[fine].error <= 0.001 * levels.bounding_diagonal < told[fine + 1].error
    half = levels.skin(triangles=400)
    posed = [s.deformer().pose(s.transforms[3]).positions for s in (skin, half)]
    assert volume(posed[1], half.triangles) == pytest.approx(volume(posed[0], skin.triangles), rel=0.03)
    with pytest.raises(sphmesh.LimitError):
        levels.skin(levels.collapse_count)  # no triangles are left
    with pytest.raises(TypeError):
        levels.find()


def test_attributes_come_along_and_locks_hold(skin):
    rest = np.array(skin.rest)
    locked = np.arange(402) % 50 == 7
    normals = rest / np.linalg.norm(rest, axis=1, keepdims=True)
    levels = skin.simplified(attributes=rest[:, :2], normals=normals, locked=locked, method="position")
    assert levels.attribute_count == 2
    start = levels.attributes(0)
    order = start.vertex_sources
    assert np.array_equal(np.sort(order), np.arange(402)) and np.array_equal(start.values, rest[order][:, :2])
    assert np.array_equal(np.sort(start.triangle_sources), np.arange(800))
    number = levels.find(triangles=200)
    coarse, told = levels.skin(number), levels.attributes(number)
    for vertex in np.flatnonzero(locked):
        place = np.flatnonzero((coarse.rest == rest[vertex]).all(axis=1))
        assert len(place) == 1 and np.allclose(told.values[place[0]], rest[vertex, :2])
    assert np.abs(told.values[:, 0] - coarse.rest[:, 0]).max() < 0.3  # x came along as a colour would
    assert np.allclose(np.linalg.norm(told.normals, axis=1), 1, atol=1e-5)
    assert levels.skin(number).influence_count <= 2 and skin.simplified(influences=1).skin(0).influence_count == 1
    with pytest.raises(ValueError, match="shape"):
        skin.simplified(attributes=rest[1:])


def test_a_cursor_walks_over_points(skin):
    levels = skin.simplified(method="rest")
    cursor = levels.cursor()
    expected = levels.skin(levels.find(vertices=50))
    del levels
    points, edges, triangles = cursor.move(50).read()
    assert len(points) == 50 and len(triangles) == len(expected.triangles)
    levels = skin.simplified(method="rest")
    rest = np.array([levels.point(int(p))[0] for p in points])
    assert np.array_equal(np.unique(rest, axis=0), np.unique(expected.rest, axis=0))
    assert levels.point(0)[2].sum() == pytest.approx(1)


def test_a_rig_in_a_file_gets_levels(tmp_path, skin):
    skin.save(tmp_path / "tube.glb")
    with sphmesh.RigLevels(tmp_path / "tube.glb", method="rest") as rig:
        levels = rig.progressive
        number = levels.find(triangles=100)
        count = levels.describe(number).triangle_count
        rig.save(tmp_path / "small.glb", [number])
        assert rig.rig.names == sphmesh.Rig(tmp_path / "tube.glb").names
    assert levels.collapse_count > 0  # the file's levels are there as long as somebody looks at them
    again = sphmesh.Skin.open(tmp_path / "small.glb")
    assert len(again.triangles) == count and again.bone_count == 2


def test_a_rig_in_a_file_tells_its_joints(tmp_path, skin):
    skeleton = skin.skeleton(root=0)
    skin.save(tmp_path / "tube.glb", skeleton=skeleton)
    rig = sphmesh.Rig(tmp_path / "tube.glb")
    assert len(set(rig.names)) == 2 and all(rig.names) and len(rig.nodes) == 2 and not rig.morphs and len(rig.edges) == 0
    assert rig.parents.tolist() == [sphmesh.NO_JOINT, 0]
    assert np.allclose(rig.inverse_bind, skeleton.inverse_bind, atol=1e-6)
    square = [np.concatenate([a, np.broadcast_to([0, 0, 0, 1], (*a.shape[:-2], 1, 4))], -2)
              for a in (rig.joints, rig.inverse_bind)]
    assert np.allclose((square[0] @ square[1])[..., :3, :], rig.skin.transforms, atol=1e-6)
    assert np.allclose(rig.joints_rest[1][:, 3], skeleton.positions[1], atol=1e-6)
    clip, = sphmesh.clips(tmp_path / "tube.glb")
    assert clip.frame_count == 4 and clip.duration == pytest.approx(0.1)


def test_the_field_of_a_ball_is_its_distance():
    points, triangles = ball(1.5)
    skin = sphmesh.Skin(points, np.zeros((len(points), 1), int), np.ones((len(points), 1)), triangles=triangles)
    implicit = skin.implicit(samples=200)
    part = implicit.part(0)
    assert implicit.bone_count == 1 and implicit.joints == [] and part.vertex_count == len(points)
    assert np.allclose(np.linalg.norm(part.samples, axis=1), 1.5, atol=0.02) and part.samples.shape == part.normals.shape
    rng = np.random.default_rng(4)
    ways = rng.normal(size=(50, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    for radius in (1.3, 1.5, 1.7):
        distances, gradients = implicit.distances(0, radius * ways)
        assert np.allclose(distances, radius - 1.5, atol=0.05)  # "about"
        further, _ = implicit.distances(0, (radius + 1e-5) * ways)
        assert np.allclose((gradients * ways).sum(axis=1), (further - distances) / 1e-5, atol=1e-3)
        assert ((gradients * ways).sum(axis=1) > 0.98 * np.linalg.norm(gradients, axis=1)).all()
    field = implicit.evaluate(1.5 * ways, evaluation="exact", gradients=True)
    assert np.allclose(field.values, 0.5, atol=0.05) and (field.bones == 0).all()
    assert ((field.gradients * ways).sum(axis=1) < 0).all()
    assert implicit.evaluate([[0, 0, 99]]).values[0] == 0
    assert implicit.evaluate([[0, 0, 99]]).bones[0] == sphmesh.NO_BONE
    moved = np.eye(4)[None] + [[[0, 0, 0, 5]] + 3 * [[0, 0, 0, 0]]]
    assert np.allclose(implicit.evaluate(1.5 * ways + [5, 0, 0], moved).values, 0.5, atol=0.06)


def test_joints_may_be_changed_saved_and_given(tmp_path, skin, implicit):
    joint, = implicit.joints
    assert joint.bones == (0, 1) and joint.operation == "union" and joint.position == pytest.approx((2, 0, 0), abs=0.3)
    edited = sphmesh.Implicit.from_bytes(implicit.to_bytes())
    edited.set_joint(0, joint._replace(operation="bulge", strength=0.25, curve=None))
    assert edited.joints[0].curve == sphmesh.Curve.preset("bulge") and edited.joints[0].strength == 0.25
    edited.save(tmp_path / "tube.sphm")
    again = sphmesh.load(tmp_path / "tube.sphm")
    assert isinstance(again, sphmesh.Implicit) and again.joints == edited.joints and again.to_bytes() == edited.to_bytes()
    given = skin.implicit(joints=[sphmesh.Joint((0, 1), (2, 0, 0), "blend")], parents=[sphmesh.NO_BONE, 0])
    assert given.joints[0].operation == "blend"
    with pytest.raises(sphmesh.InvalidError):
        edited.set_joint(1, joint)


def test_operators_are_their_closed_forms():
    for first, second in ((0.2, 0.6), (0.5, 0.5), (0.65, 0.1)):
        value, slopes = sphmesh.compose("union", math.pi / 4, first, second)
        assert value == max(first, second)
        blended, slopes = sphmesh.compose("blend", 0.2, first, second)
        step = 1e-6
        moved, _ = sphmesh.compose("blend", 0.2, first + step, second)
        assert blended >= value and (moved - blended) / step == pytest.approx(slopes[0], abs=1e-4)
    curve = sphmesh.Curve.preset("blend")
    assert curve.at(0) == pytest.approx(math.pi / 4) and curve.at(math.pi) == pytest.approx(math.pi / 4)
    assert curve.at(math.pi / 4) == pytest.approx(curve.thetas[1])


def test_a_tracker_leaves_the_rest_pose_alone_and_adds_no_intersections(skin, implicit):
    tracker = implicit.tracker(skin, counted=True)
    still = tracker.pose(skin.transforms[0])
    assert np.allclose(still.positions, skin.rest, atol=1e-3) and still.reports[0]["pairs_after"] == 0
    poses = tracker.pose(skin.transforms, normals=True)
    assert poses.positions.shape == (4, 402, 3) and (poses.reports["pairs_after"] <= poses.reports["pairs_before"]).all()
    assert poses.reports["moved"][3] > 0
    blended = skin.deformer().pose(skin.transforms[3], method="dual_quaternion").positions
    moved = np.linalg.norm(poses.positions[3] - blended, axis=1)
    assert moved.max() == pytest.approx(poses.reports["farthest"][3], abs=1e-5)
    assert sphmesh.intersections(poses.positions[3], skin.triangles) == poses.reports["pairs_after"][3]
    assert np.allclose(np.linalg.norm(poses.normals, axis=2), 1, atol=1e-4)
    plain = implicit.tracker(skin, guarded=False, method="linear", iterations=1).pose(skin.transforms[3])
    assert plain.reports[0]["pairs_after"] == 0  # nobody counts


def test_triangles_that_cross_are_counted():
    points = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0.5, 0.5, -1], [0.5, 0.5, 1], [3, 3, 0]]
    assert sphmesh.intersections(points, [[0, 1, 2], [3, 4, 5]]) == 1
    apart = np.array(points)
    apart[3:, 2] += 5
    assert sphmesh.intersections(apart, [[0, 1, 2], [3, 4, 5]]) == 0
