#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The examples that take files, on the creature: what they say and write is what plain sums over the files give.

usage: test_examples.py PROGRAM FOLDER-OF-EXAMPLES"""
import json
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile

from support import Case, main

EXAMPLES = os.path.abspath(sys.argv[2])


def example(name, *arguments, keys=""):
    return subprocess.run([os.path.join(EXAMPLES, name), *arguments], cwd=FOLDER, input=keys, capture_output=True,
                          text=True, timeout=600)


def setUpModule():
    global FOLDER
    FOLDER = tempfile.mkdtemp()
    Case().succeeds("demo", "-o", FOLDER, "--frame-count", 12, "--resolution", 32, "--samples", 10, "--quiet")


def tearDownModule():
    shutil.rmtree(FOLDER)


def read(name):
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        return json.load(file)


def mix(weights, points):
    return [sum(w * p[i] for w, p in zip(weights, points)) for i in range(len(points[0]))]


def parts(level, frame):
    """Corners (x, y, z, r) of the primitives of a level of constant radii, at a frame that may lie between two."""
    before = int(frame)
    after = min(before + 1, level["frames"] - 1)
    spheres = [mix((1 - frame + before, frame - before), (a, b)) + [r] for a, b, r in
               zip(level["centers"][before], level["centers"][after], level["radii"])]
    return [[spheres[i] for i in part] for part in level["edges"] + level["triangles"]]


def samples(part, steps):
    """Spheres interpolated over a part, on a grid."""
    if len(part) == 2:
        return [mix((i / steps, 1 - i / steps), part) for i in range(steps + 1)]
    return [mix((i / steps, j / steps, (steps - i - j) / steps), part)
            for i in range(steps + 1) for j in range(steps + 1 - i)]


def pc2(name):
    with open(os.path.join(FOLDER, name), "rb") as file:
        data = file.read()
    points, frames = struct.unpack_from("<i8xi", data, 16)
    xyz = struct.unpack_from(f"<{3 * points * frames}f", data, 32)
    return [[xyz[i:i + 3] for i in range(3 * points * f, 3 * points * (f + 1), 3)] for f in range(frames)]


class Host(Case):
    def test_a_host_of_ones_own_gets_the_bytes_that_the_program_writes(self):
        done = example("host", "creature.obj", "creature.pc2", "host.sphm")
        self.assertEqual(done.returncode, 0, done.stderr)  # 0 only where all memory has come back
        self.assertGreater(int(done.stdout.split()[0]), 0)
        self.succeeds("build", "creature.obj", "--cache", "creature.pc2", "-o", "one.sphm", "--threads", 1, cwd=FOLDER)
        with open(os.path.join(FOLDER, "host.sphm"), "rb") as a, open(os.path.join(FOLDER, "one.sphm"), "rb") as b:
            self.assertEqual(a.read(), b.read())


class Browser(Case):
    def test_keys_change_the_level_and_the_frame(self):
        done = example("lod_browser", "creature.sphm", keys="-]]np---------+q")
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = re.findall(r"^frame (\d+): (\d+) spheres, (\d+) wire edges, (\d+) triangles", done.stdout, re.M)
        self.assertEqual([int(spheres) for _, spheres, _, _ in lines],
                         [40, 20, 21, 22, 22, 22, 11, 5, 2, 1, 1, 1, 1, 1, 1, 2])
        self.assertEqual([int(frame) for frame, *_ in lines[:6]], [0, 0, 0, 0, 1, 0])
        for _, spheres, edges, triangles in lines[:3]:
            self.succeeds("level", "creature.sphm", "--spheres", spheres, "-o", "k.json", "--quiet", cwd=FOLDER)
            level = read("k.json")
            self.assertEqual((int(edges), int(triangles)), (len(level["edges"]), len(level["triangles"])))

    def test_the_picture_shows_what_rays_along_z_would_meet(self):
        width, height = 72, 24
        picture = example("lod_browser", "creature.sphm", keys="q").stdout.split("\n")[:height]
        self.succeeds("level", "creature.sphm", "--spheres", 1, "-o", "one.json", "--quiet", cwd=FOLDER)
        middle = read("one.json")["centers"][0][0]
        size = self.json("info", "creature.obj", "--cache", "creature.pc2", cwd=FOLDER)["bounding_diagonal"] / 2
        spheres = [s for part in parts(read("level-40.json"), 0) for s in samples(part, 12)]
        sure = 0
        for row in range(1, height, 2):
            for column in range(row % 5, width, 5):
                x = middle[0] + 2 * size * (column + 0.5 - width / 2) / width
                y = middle[1] - 4 * size * (row + 0.5 - height / 2) / width
                away = min(math.hypot(x - s[0], y - s[1]) - s[3] for s in spheres)
                if abs(away) > 0.01 * size:  # the grid is not the whole solid
                    self.assertEqual(picture[row][column] != " ", away < 0, (row, column, away))
                    sure += 1
        self.assertGreater(sure, 100)


class GameLoop(Case):
    def test_the_player_is_never_in_the_character(self):
        done = example("game_loop", "level-40.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        level = read("level-40.json")
        middle = mix([1 / level["spheres"]] * level["spheres"], level["centers"][0])
        radius = 0.05 * max(abs(c[i] - middle[i]) for c in level["centers"][0] for i in range(3))
        lines = re.findall(r"s, frame +([\d.]+): player at (\S+) (\S+) (\S+)", done.stdout)
        self.assertEqual(len(lines), 9)
        distances = []
        for frame, *place in lines:
            place = [float(x) for x in place]
            distances.append(min(math.dist(place, s[:3]) - s[3]
                                 for part in parts(level, float(frame)) for s in samples(part, 24)))
        self.assertGreater(min(distances), radius - 1e-4)  # a grid overestimates distances, by little
        self.assertLess(min(distances), 1.05 * radius)     # and it did get there
        self.assertTrue(any(float(frame) % 1 for frame, *_ in lines))
        hits, hidden = re.search(r"(\d+) projectiles hit; .* for (\d+) of 180", done.stdout).groups()
        self.assertGreater(int(hits), 0)
        self.assertGreater(int(hidden), 0)


class RigExport(Case):
    def test_the_rig_plays_the_animation_and_the_capsules_contain_it(self):
        done = example("rig_export", "creature.obj", "creature.pc2", "rig.glb", "capsules.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        said = float(re.search(r"off by ([\d.]+) %", done.stdout)[1])
        self.succeeds("pose", "rig.glb", "--fps", 24, "-o", "played.pc2", cwd=FOLDER)
        frames, played = pc2("creature.pc2"), pc2("played.pc2")
        self.assertEqual(len(frames), len(played))
        squares = [math.dist(a, b) ** 2 for f, g in zip(frames, played) for a, b in zip(f, g)]
        diagonal = sum(math.dist(*[[pick(v[i] for v in f) for i in range(3)] for pick in (min, max)])
                       for f in frames) / len(frames)
        self.assertAlmostEqual(100 * math.sqrt(sum(squares) / len(squares)) / diagonal, said, delta=0.01)
        self.assertLess(said, 0.5)

        proxies = read("capsules.json")
        self.assertTrue(proxies["coverage"]["contains_all_vertices"])
        pose = proxies["poses"][7]
        spheres = [s for kind in ("spheres", "capsules", "triangles") for p in pose[kind]
                   for s in samples_of(p["centers"], p["radii"])]
        out = [min(math.dist(v, s[:3]) - s[3] for s in spheres) for v in frames[7][::97]]
        self.assertLess(max(out), 0.002 * diagonal)  # what the grid leaves out


def glb(name):
    """The JSON of a GLB, and of each vertex of its mesh the position at rest, the joints and their weights."""
    with open(os.path.join(FOLDER, name), "rb") as file:
        data = file.read()
    size, = struct.unpack_from("<I", data, 12)
    scene = json.loads(data[20:20 + size])

    def rows(attribute, width, kind):
        accessor = scene["accessors"][scene["meshes"][0]["primitives"][0]["attributes"][attribute]]
        view = scene["bufferViews"][accessor["bufferView"]]
        start = 28 + size + view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        values = struct.unpack_from(f"<{width * accessor['count']}{kind}", data, start)
        return [values[i:i + width] for i in range(0, len(values), width)]
    return scene, list(zip(rows("POSITION", 3, "f"), rows("JOINTS_0", 4, "B"), rows("WEIGHTS_0", 4, "f")))


class BendRig(Case):
    def test_vertices_turn_as_far_as_dual_quaternions_say_but_for_what_is_corrected(self):
        scene, vertices = glb("creature-rig.glb")
        joints = scene["skins"][0]["joints"]
        bone = next(j for j, node in enumerate(joints) if "children" not in scene["nodes"][node])
        pivot, node = [0, 0, 0], joints[bone]
        while node is not None:  # joints are not turned at rest
            pivot = [a + b for a, b in zip(pivot, scene["nodes"][node].get("translation", [0, 0, 0]))]
            node = next((i for i, n in enumerate(scene["nodes"]) if node in n.get("children", [])), None)
        done = example("bend_rig", "creature-rig.glb", str(bone), "60", "bent.obj")
        self.assertEqual(done.returncode, 0, done.stderr)
        farthest, before, after = map(float, re.search(
            r"by up to ([\d.]+); (\d+) pairs of triangles intersected, (\d+) do", done.stdout).groups())
        self.assertLessEqual(after, before)
        with open(os.path.join(FOLDER, "bent.obj"), encoding="utf-8") as file:
            bent = [tuple(map(float, line.split()[1:])) for line in file if line.startswith("v ")]
        self.assertEqual(len(bent), len(vertices))
        turned = as_blended = 0
        for (rest, bones, weights), there in zip(vertices, bent):
            # blended with standing still, a turn is one about the same axis by another angle
            weight = sum(w for j, w in zip(bones, weights) if j == bone)
            half = math.atan2(weight * math.sin(math.pi / 6), 1 - weight + weight * math.cos(math.pi / 6))
            way = 2 * math.sin(half) * math.hypot(rest[0] - pivot[0], rest[1] - pivot[1])
            off = abs(math.dist(rest, there) - way)
            self.assertLess(off, farthest + 1e-3)
            turned += way > 0.05
            as_blended += way > 0.001 and off < 1e-5
        self.assertGreater(turned, 30)
        self.assertGreaterEqual(as_blended, 3)


def samples_of(centers, radii):
    part = [c + [r] for c, r in zip(centers, radii)]
    return part if len(part) == 1 else samples(part, 16)


class Sizes(Case):
    def test_an_example_is_under_a_hundred_lines(self):
        source = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../examples")
        for name in os.listdir(source):
            if name.endswith(".c") and not name.startswith("particles"):
                with open(os.path.join(source, name), encoding="utf-8") as file:
                    self.assertLess(len(file.readlines()), 100, name)

    def test_what_is_wrong_is_said(self):
        for name in ("host", "lod_browser", "game_loop", "pose_loop", "rig_export", "bend_rig"):
            self.assertEqual(example(name).returncode, 2, name)
        for arguments in (("host", "no.obj", "no.pc2", "x"), ("lod_browser", "no.sphm"), ("game_loop", "no.json"),
                          ("rig_export", "no.obj", "no.pc2", "x.glb", "x.json"),
                          ("pose_loop", "no.glb"), ("bend_rig", "no.glb", "0", "1", "x.obj")):
            done = example(*arguments)
            self.assertEqual(done.returncode, 1)
            self.assertIn("no.", done.stderr)


if __name__ == "__main__":
    main()
