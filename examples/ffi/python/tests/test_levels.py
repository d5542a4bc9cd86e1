# SPDX-License-Identifier: MIT
"""Hierarchies, levels and what levels are asked, against closed forms, brute force and the program."""
import json
import os
import pathlib
import subprocess

import numpy as np
import pytest
import sphmesh
from conftest import ball, torus

FRAMES, TRIANGLES = torus()
PROGRAM = os.environ.get("SPHMESH_PROGRAM")


@pytest.mark.skipif(PROGRAM is None, reason="SPHMESH_PROGRAM is not set")
def test_the_program_builds_the_same_hierarchy(tmp_path, hierarchy):
    sphmesh.Animation(FRAMES, TRIANGLES).save(tmp_path / "torus.obj", tmp_path / "torus.pc2")
    subprocess.run([PROGRAM, "build", "torus.obj", "--cache", "torus.pc2", "-o", "torus.sphm", "--quiet"], cwd=tmp_path,
                   check=True)
    assert (tmp_path / "torus.sphm").read_bytes() == hierarchy.to_bytes()


def test_files_come_back_as_they_were(tmp_path, hierarchy):
    animation = sphmesh.Animation(FRAMES, TRIANGLES, [[0, 100]])
    for cache in ("a.pc2", "a.mdd"):
        animation.save(tmp_path / "a.obj", tmp_path / cache)
        again = sphmesh.open_animation(tmp_path / "a.obj", cache=tmp_path / cache)
        assert np.array_equal(again.triangles, TRIANGLES) and again.edges.tolist() == [[0, 100]]
        assert all(np.array_equal(again.read_frame(f), FRAMES[f]) for f in range(4))
    assert sphmesh.describe(tmp_path / "a.pc2").frame_count == 4
    turned = sphmesh.open_animation(tmp_path / "a.obj", up="z", scale=2, weld="all")
    assert np.array_equal(turned.read_frame(0), 2 * FRAMES[0][:, [0, 2, 1]] * np.float32([1, 1, -1]))
    hierarchy.save(tmp_path / "h.sphm")
    level = hierarchy.level(12)
    level.save(tmp_path / "l.sphm")
    level.save(tmp_path / "l.json")
    assert sphmesh.load(tmp_path / "h.sphm").to_bytes() == hierarchy.to_bytes()
    assert sphmesh.Hierarchy.from_bytes(hierarchy.to_bytes()).to_bytes() == hierarchy.to_bytes()
    assert sphmesh.load(tmp_path / "l.sphm").to_bytes() == level.to_bytes()
    assert sphmesh.Level.from_bytes(level.to_bytes()).to_bytes() == level.to_bytes()
    assert np.array_equal(sphmesh.load(tmp_path / "l.json").centers, level.centers)
    assert np.allclose(json.loads((tmp_path / "l.json").read_text())["radii"], level.radii)


def test_vertices_that_coincide_are_welded():
    welded, renumbered = sphmesh.Animation(np.tile(FRAMES, (1, 2, 1)), np.concatenate([TRIANGLES, TRIANGLES + 288])).weld()
    assert welded.vertex_count == 288
    assert np.array_equal(renumbered, np.tile(np.arange(288), 2))


def test_collapses_tell_the_whole_history(hierarchy):
    steps = hierarchy.collapses()
    assert hierarchy.least_count == 1 and len(steps) == 287 == hierarchy.collapse_count
    assert np.array_equal(steps["node"], 288 + np.arange(287))
    assert np.array_equal(np.sort(np.concatenate([steps["u"], steps["v"]])), np.arange(574))  # each node but the last
    assert (np.diff(steps["error"]) >= 0).all()
    assert hierarchy.collapses(280, 3).tobytes() == steps[280:283].tobytes()
    assert [hierarchy.error_for_count(288 - done) for done in (0, 1, 201)] == [0, steps["error"][0], steps["error"][200]]
    with pytest.raises(ValueError):
        hierarchy.error_for_count(0)
    error = float(steps["error"][200])
    expected = 288 - int((steps["error"] <= error).sum())
    assert hierarchy.count_for_error(error) == hierarchy.level(error=error).sphere_count == expected
    with pytest.raises(TypeError):
        hierarchy.level()


def test_a_cursor_shows_what_a_level_has(hierarchy):
    cursor = hierarchy.cursor()
    for count in (40, 7, 100):
        nodes, edges, triangles = cursor.move(count).read()
        level = hierarchy.level(count)
        assert np.array_equal(nodes[level.edges], edges) and np.array_equal(nodes[level.triangles], triangles)
        for place, node in enumerate(nodes):
            centers, radii = hierarchy.sphere(int(node))
            assert np.array_equal(level.centers[:, place], centers) and (radii == level.radii[place]).all()


def test_options_do_what_they_say():
    animation = sphmesh.Animation(FRAMES, TRIANGLES)
    assert (animation.build(radius="zero").level(10).radii == 0).all()
    assert animation.build(radius="per_frame").level(10).radii.shape == (4, 10)
    weights = np.ones((4, 288), np.float32)
    per_vertex, per_frame = (animation.build(weights=w) for w in (weights[0], weights))
    plain = animation.build(importance="none")
    assert per_vertex.to_bytes() == per_frame.to_bytes()
    assert np.array_equal(per_vertex.level(10).labels, plain.level(10).labels)
    some = animation.build().level(10, first_frame=1, frame_count=2, labels=False)
    assert some.frame_count == 2 and len(some.labels) == 0
    assert np.array_equal(some.centers, animation.build().level(10).centers[1:3])


def test_a_level_of_your_own_comes_back(level):
    copy = sphmesh.Level(level.centers, level.radii, level.edges, level.triangles, level.labels)
    assert copy.to_bytes() == level.to_bytes()
    with pytest.raises(sphmesh.InvalidError, match="radius"):
        sphmesh.Level([[0, 0, 0]], [-1])


def test_optimising_leaves_the_level_alone_and_moves_labels_to_nearer_spheres(level, animation):
    before = level.to_bytes()
    better = level.optimized(animation)
    assert level.to_bytes() == before and np.array_equal(better.centers, level.centers)

    def cost(labels):
        distance = np.linalg.norm(FRAMES - level.centers[:, labels], axis=2) - level.radii[labels]
        return distance.sum(axis=0)

    changed = better.labels != level.labels
    assert changed.any()
    assert (cost(better.labels)[changed] < cost(level.labels)[changed]).all()


def test_casts_and_distances_are_those_of_spheres():
    rng = np.random.default_rng(3)
    centers, radii = rng.uniform(-2, 2, (9, 3)), rng.uniform(0.1, 0.5, 9)
    query = sphmesh.Level(centers, radii).query()
    points = rng.uniform(-3, 3, (500, 3)).astype(np.float32)
    apart = np.linalg.norm(points[:, None] - centers, axis=2) - radii
    assert np.allclose(query.distance(points), apart.min(axis=1), atol=1e-6)
    assert np.array_equal(query.nearest(points)["contact"]["simplex"], apart.argmin(axis=1))
    assert np.array_equal(query.contains(points, cavities="space"), (apart <= 0).any(axis=1))
    start, end = points[:250], points[250:]
    way, to = (end - start).astype(float), start[:, None] - centers
    a, b = (way ** 2).sum(1)[:, None], (to * way[:, None]).sum(2)
    inside = b ** 2 - a * ((to ** 2).sum(2) - (radii + 0.05) ** 2)
    with np.errstate(invalid="ignore"):
        s = (-b - np.sqrt(inside)) / a
    s = np.where((s >= 0) & (s <= 1), s, np.inf).min(axis=1)
    free = (np.linalg.norm(to, axis=2) > radii + 0.05).all(axis=1)
    hits = query.cast(start, end, 0.05)
    assert np.array_equal(hits["hit"][free] == 1, np.isfinite(s)[free]) and np.isfinite(s[free]).sum() > 20
    found = free & np.isfinite(s)
    assert np.allclose(hits["s"][found], s[found], atol=1e-5)
    assert np.array_equal(query.cast_any(start, end, 0.05), hits["hit"] == 1)
    moving, out = sphmesh.sweeps(start, end, 0.05), np.empty(250, sphmesh.HIT)
    assert query.cast_sweeps(moving, out=out) is out and out.tobytes() == hits.tobytes()


def test_poses_move_what_is_asked():
    query = sphmesh.Level([[[0, 0, 0]], [[4, 0, 0]]], [1]).query(0.25)
    assert query.distance([10, 0, 0]) == 8
    assert query.pose(1).distance([10, 0, 0]) == 5
    assert query.pose_centers([[7, 0, 0]], [2]).distance([10, 0, 0]) == 1
    rows = np.zeros((3, 7), np.float32)
    rows[:, 0] = 10, 11, 12
    assert query.distance(rows[:, :3]).tolist() == [1, 2, 3]  # a stride of 28 bytes
    with pytest.raises(ValueError, match="2 centres for 1"):
        query.pose_centers([[0, 0, 0], [1, 1, 1]])
    assert len(query.cast(np.empty((0, 3)), np.empty((0, 3)))) == 0


def test_two_levels_touch_where_they_must():
    first = sphmesh.Level([[0, 0, 0], [0, 4, 0]], [1, 1], edges=[[0, 1]]).query()
    second = sphmesh.Level([[5, 2, 0]], [1.5]).query()
    gap = first.between(second)
    assert gap.distance == pytest.approx(2.5) and gap.first.point == pytest.approx((1, 2, 0))
    moved = first.cast_between([5, 0, 0], second)
    assert moved.hit == 1 and moved.s == pytest.approx(0.5)


def test_a_surface_is_closed_and_has_the_volume_of_its_sphere():
    surface = sphmesh.Level([[1, 2, 3]], [2]).surface(resolution=48)
    assert len(surface) == 1 and surface.cell == pytest.approx(4 / 48, rel=0.2)
    points, normals, triangles = surface[0]
    a, b, c = (points[triangles[:, k]].astype(float) for k in range(3))
    assert (np.cross(a, b) * c).sum() / 6 == pytest.approx(4 / 3 * np.pi * 8, rel=0.01)
    assert np.allclose(np.linalg.norm(points - [1, 2, 3], axis=1), 2, atol=1e-5)
    assert np.allclose(normals, (points - [1, 2, 3]) / 2, atol=1e-4)
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    assert len(points) - len(edges) // 2 + len(triangles) == 2
    with pytest.raises(IndexError):
        surface[1]


def test_measures_are_the_distance_of_two_balls():
    points, triangles = ball(1.25, 64, 128)
    animation = sphmesh.Animation(points, triangles)
    told = sphmesh.Level([[0, 0, 0]], [1]).measure(animation, samples=4000)
    assert told.mean.mean12 == pytest.approx(0.25, abs=0.002) and told.mean.area2 == pytest.approx(4 * np.pi, rel=0.03)
    assert told.frames["hausdorff"].tolist() == [told.mean.hausdorff]
    other = sphmesh.measure_meshes(animation, sphmesh.Animation(points + [0, 0, 3], triangles), samples=500)
    assert other.mean.max12 == pytest.approx(3, abs=0.02)


def test_inflation_covers_what_sticks_out():
    points, triangles = ball(1.5)
    animation, level = sphmesh.Animation(points, triangles), sphmesh.Level([[0, 0, 0]], [1])
    assert level.coverage(animation).distance == pytest.approx(0.5, abs=1e-6)
    assert level.coverage(animation).uncovered_count == len(points)
    larger, told = level.inflate(animation, margin=0.25)
    assert told.grown_count == 1 and told.max_growth == pytest.approx(0.75, abs=1e-3)
    assert told.volume_after == pytest.approx(4 / 3 * np.pi * 1.75 ** 3, rel=0.02)
    assert level.inflated(animation, margin=0.25).to_bytes() == larger.to_bytes()
    assert larger.coverage(animation).uncovered_count == 0 and larger.radii[0] == pytest.approx(1.75, abs=1e-3)


def test_exports_say_what_they_hold(tmp_path, level, animation):
    told = level.export(tmp_path / "l.json", format="primitives", frame_step=2)
    assert (told.frame_count, told.capsule_count, told.triangle_count) == (2, len(level.edges), len(level.triangles))
    assert json.loads((tmp_path / "l.json").read_text())["frames"] == 2
    covered = level.coverage(animation)
    level.export(tmp_path / "l.json", format="primitives", coverage=covered)
    said = json.loads((tmp_path / "l.json").read_text())["coverage"]
    assert (said["largest_uncovered_distance"], said["frame"], said["vertex"], said["uncovered"]) == (
        covered.distance, covered.frame, covered.vertex, covered.uncovered_count)
    told = sphmesh.Level([[0, 0, 0]], [1]).export(tmp_path / "l.urdf", name="ball")
    assert told.sphere_count == 1 and 'name="ball"' in (tmp_path / "l.urdf").read_text()
    level.surface(resolution=16).save(tmp_path / "s.ply", 1)
    assert (tmp_path / "s.ply").read_bytes().startswith(b"ply")


def test_large_data_may_live_in_a_file(tmp_path, hierarchy):
    context = sphmesh.SpillingContext(16 << 20, tmp_path, threads=1)
    animation = sphmesh.Animation(FRAMES, TRIANGLES, context=context)
    assert animation.build().to_bytes() == hierarchy.to_bytes()
    assert context.figures.file_bytes > 0
    context.trim()


def test_the_quadric_of_planes_around_a_ball_finds_the_ball():
    quadric = sphmesh.Quadric(2)
    rng = np.random.default_rng(6)
    centers = np.array([[1.0, 2, 3], [-4, 5, 6]])
    for frame, center in enumerate(centers):
        for normal in rng.normal(size=(20, 3)):
            normal /= np.linalg.norm(normal)
            quadric.add_plane(frame, center + 0.7 * normal, normal, 2.0)
    found = quadric.minimize()
    assert found.radius == pytest.approx(0.7) and np.allclose(found.centers, centers) and found.cost < 1e-10
    assert found.degenerate_frames == 0 and quadric.evaluate(centers, 1.7) == pytest.approx(80)  # 40 planes, off by 1
    quadric += quadric
    assert quadric.evaluate(centers, 1.7) == pytest.approx(160)
    quadric.add_attachment(0, centers[0] + [3, 0, 0], 0.5)
    assert quadric.evaluate(centers, 0.7) == pytest.approx(4.5)
    assert quadric.minimize(0.5).radius == 0.5
    with pytest.raises(sphmesh.InvalidError, match="2"):
        quadric.add_plane(2, [0, 0, 0], [1, 0, 0])


def test_meshes_are_saved(tmp_path):
    sphmesh.save_mesh(tmp_path / "m.obj", FRAMES[1], TRIANGLES)
    again = sphmesh.open_animation(tmp_path / "m.obj")
    assert np.array_equal(again.read_frame(0), FRAMES[1]) and np.array_equal(again.triangles, TRIANGLES)
    assert sphmesh.clips(tmp_path / "m.obj") == [] and sphmesh.objects(tmp_path / "m.obj") == (None, [])


def test_frames_are_saved_and_played_back(tmp_path):
    sphmesh.save_frames(tmp_path / "m.glb", FRAMES, TRIANGLES, fps=10)
    again = sphmesh.open_animation(tmp_path / "m.glb", fps=10)
    assert again.frame_count == len(FRAMES)
    for frame, expected in enumerate(FRAMES):
        assert np.allclose(again.read_frame(frame), expected, atol=1e-5)
    with pytest.raises(ValueError, match="not"):
        sphmesh.save_frames(tmp_path / "m.glb", FRAMES[0], TRIANGLES)


def test_an_archive_tells_its_objects():
    file = pathlib.Path(__file__).resolve().parents[4] / "tests/io/fixtures/alembic_scene.abc"
    archive, told = sphmesh.objects(file)
    assert archive.application == "make_alembic.py" and archive.version == 10800
    kinds = {thing.path: thing.kind for thing in told}
    assert kinds["/root"] == "Xform" and kinds["/root/cage"] == "SubD" and kinds["/root/hair"] == "Curve"
    assert [t.path for t in told if t.hidden and t.vertex_count] == ["/root/ghost/ghostShape"]
    chosen = sum(thing.vertex_count for thing in told if thing.chosen)
    assert sphmesh.open_animation(file).vertex_count == chosen == 26
    body = sphmesh.open_animation(file, object="body")
    assert body.vertex_count == 8
