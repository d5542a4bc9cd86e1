#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sphmesh pose on a rig that is made here, whose poses are known by sines and cosines."""
import json
import math
import os
import shutil
import struct
import tempfile

from support import Case, main

SIDES, RINGS = 12, 7  # a tube along x from 0 to 2, radius 0.5; the joint in its middle turns about x or z
RING_WEIGHTS = [0, 0, 0.25, 0.5, 0.75, 1, 1]


def tube():
    return [(r / 3, 0.5 * math.cos(2 * math.pi * s / SIDES), 0.5 * math.sin(2 * math.pi * s / SIDES))
            for r in range(RINGS) for s in range(SIDES)]


def faces():
    out = []
    for r in range(RINGS - 1):
        for s in range(SIDES):
            a, b, n = r * SIDES + s, r * SIDES + (s + 1) % SIDES, SIDES
            out += [a, b, a + n, b, b + n, a + n]
    return out


def write_rig(name):
    """Two clips of a second: `bend` turns the second joint by 90 degrees about z, `twist` by 170 about x."""
    binary, views, accessors = b"", [], []

    def add(kind, component, numbers):
        nonlocal binary
        data = struct.pack(f"<{len(numbers)}{ {5126: 'f', 5123: 'H', 5121: 'B'}[component]}", *numbers)
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[kind]
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "type": kind,
                          "count": len(numbers) // width})
        binary += data + bytes(-len(data) % 4)
        return len(accessors) - 1

    def turn(axis, degrees):
        half = math.radians(degrees) / 2
        return [math.sin(half) * (axis == k) for k in range(3)] + [math.cos(half)]

    identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]
    weights = [w for ring in RING_WEIGHTS for _ in range(SIDES) for w in (1 - ring, ring, 0, 0)]
    primitive = {"attributes": {"POSITION": add("VEC3", 5126, [x for p in tube() for x in p]),
                                "JOINTS_0": add("VEC4", 5121, [0, 1, 0, 0] * (SIDES * RINGS)),
                                "WEIGHTS_0": add("VEC4", 5126, weights)},
                 "indices": add("SCALAR", 5123, faces())}
    binds = add("MAT4", 5126, identity + [0, 0, 0, 1] + identity + [-1, 0, 0, 1])
    times = add("SCALAR", 5126, [0, 1])
    clips = []
    for clip, axis, degrees in (("bend", 2, 90), ("twist", 0, 170)):
        keys = add("VEC4", 5126, turn(axis, 0) + turn(axis, degrees))
        clips.append({"name": clip, "samplers": [{"input": times, "output": keys}],
                      "channels": [{"sampler": 0, "target": {"node": 2, "path": "rotation"}}]})
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "skin": 0}, {"name": "upper", "children": [2]},
                  {"name": "lower", "translation": [1, 0, 0]}],
        "meshes": [{"primitives": [primitive]}], "skins": [{"joints": [1, 2], "inverseBindMatrices": binds}],
        "animations": clips, "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}]}).encode()
    text += b" " * (-len(text) % 4)
    with open(os.path.join(FOLDER, name), "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def setUpModule():
    global FOLDER
    FOLDER = tempfile.mkdtemp()
    write_rig("tube.glb")


def tearDownModule():
    shutil.rmtree(FOLDER)


def content(name):
    with open(os.path.join(FOLDER, name), "rb") as file:
        return file.read()


def pc2(name):
    data = content(name)
    count, frames = struct.unpack_from("<i", data, 16)[0], struct.unpack_from("<i", data, 28)[0]
    values = struct.unpack(f"<{3 * count * frames}f", data[32:])
    return [[values[3 * i:3 * i + 3] for i in range(f * count, (f + 1) * count)] for f in range(frames)]


def mdd(name):
    data = content(name)
    frames, count = struct.unpack_from(">ii", data)
    values = struct.unpack_from(f">{3 * count * frames}f", data, 8 + 4 * frames)
    return (struct.unpack_from(f">{frames}f", data, 8),
            [[values[3 * i:3 * i + 3] for i in range(f * count, (f + 1) * count)] for f in range(frames)])


def turned(p, axis, angle):
    """About the joint at (1, 0, 0)."""
    c, s, x = math.cos(angle), math.sin(angle), p[0] - 1
    return (1 + c * x - s * p[1], s * x + c * p[1], p[2]) if axis == 2 else (p[0], c * p[1] - s * p[2], s * p[1] + c * p[2])


def linear(axis, angle):
    return [tuple((1 - w) * a + w * b for a, b in zip(p, turned(p, axis, angle)))
            for w, p in zip((w for w in RING_WEIGHTS for _ in range(SIDES)), tube())]


class Pose(Case):
    def close(self, got, expected, tolerance=1e-6):
        self.assertEqual(len(got), len(expected))
        for a, b in zip(got, expected):
            self.assertLess(math.dist(a, b), tolerance)

    def test_frames_of_all_clips_are_linear_blends(self):
        told = self.json("pose", "tube.glb", "--fps", 10, "-o", "all.pc2", cwd=FOLDER)
        frames = pc2("all.pc2")
        self.assertEqual((told["frames"], told["bones"], told["influences"], told["vertices"]),
                         (22, 2, 2, SIDES * RINGS))
        self.assertEqual([(c["name"], c["first_frame"], c["frames"]) for c in told["clips"]],
                         [("bend", 0, 11), ("twist", 11, 11)])
        for f in range(11):
            self.close(frames[f], linear(2, math.radians(90) * f / 10))
            self.close(frames[11 + f], linear(0, math.radians(170) * f / 10))

    def test_linear_blends_are_the_frames_that_convert_bakes(self):
        self.succeeds("pose", "tube.glb", "--fps", 24.7, "-o", "posed.pc2", cwd=FOLDER)
        self.succeeds("convert", "tube.glb", "--fps", 24.7, "-o", "baked.pc2", cwd=FOLDER)
        posed, baked = pc2("posed.pc2"), pc2("baked.pc2")
        self.assertEqual(len(posed), len(baked))
        for a, b in zip(posed, baked):
            self.close(a, b, 4e-7)
        self.assertEqual(content("posed.obj"), content("baked.obj"))

    def test_dual_quaternions_keep_the_section_that_linear_blends_lose(self):
        for method, radius in (("lbs", 0.5 * math.cos(math.radians(85))), ("dqs", 0.5)):
            self.succeeds("pose", "tube.glb", "--clip", "twist", "--method", method, "-o", "t.pc2", cwd=FOLDER)
            middle = pc2("t.pc2")[-1][3 * SIDES:4 * SIDES]
            for x, y, z in middle:
                self.assertAlmostEqual(math.hypot(y, z), radius, delta=1e-6)
                self.assertAlmostEqual(x, 1, delta=1e-6)

    def test_frames_are_chosen_and_have_times_in_mdd(self):
        told = self.json("pose", "tube.glb", "--clip", "bend", "--fps", 10, "--frames", "2:9:3", "-o", "b.mdd",
                         cwd=FOLDER)
        times, frames = mdd("b.mdd")
        self.assertEqual(told["frames"], 3)
        for i, f in enumerate((2, 5, 8)):
            self.close(frames[i], linear(2, math.radians(90) * f / 10))
            self.assertAlmostEqual(times[i], 0.3 * i, delta=1e-6)

    def test_one_frame_is_a_mesh_with_normals(self):
        for name in ("one.obj", "one.ply"):
            told = self.json("pose", "tube.glb", "--fps", 10, "--frame", 21, "--method", "dqs", "-o", name, cwd=FOLDER)
            self.assertEqual((told["mesh"], told["frames"]), (name, 1))
            self.assertNotIn("cache", told)
            info = self.json("info", name, cwd=FOLDER)
            self.assertEqual((info["vertices"], info["triangles"]), (SIDES * RINGS, 2 * SIDES * (RINGS - 1)))
        rows = [line.split() for line in content("one.obj").decode().splitlines()]
        vertices = [tuple(map(float, r[1:])) for r in rows if r[0] == "v"]
        normals = [tuple(map(float, r[1:])) for r in rows if r[0] == "vn"]
        middle = slice(3 * SIDES, 4 * SIDES)
        for v, n in zip(vertices[middle], normals[middle]):  # outward, as the ring is not sheared
            self.assertAlmostEqual(math.hypot(*n), 1, delta=1e-6)
            self.assertGreater((n[1] * v[1] + n[2] * v[2]) / 0.5, 0.98)

    def test_implicit_skinning_has_no_more_intersections_and_leaves_the_plain_results_beside(self):
        told = {}
        for ending in ("pc2", "glb"):
            told = self.json("pose", "tube.glb", "--clip", "bend", "--implicit", "--beside", "--pairs", "--save-fields",
                             "fields.sphm", "-o", "soft." + ending, cwd=FOLDER)
            frames = told["implicit"]["frames"]
            self.assertEqual((told["implicit"]["fields"], told["implicit"]["joints"]), (2, 1))
            self.assertEqual(len(frames), told["frames"])
            self.assertTrue(all(f["pairs_after"] <= f["pairs_before"] for f in frames))
            self.assertEqual(frames[0]["moved"], 0)
            self.assertGreater(frames[-1]["moved"], 0)
        self.succeeds("pose", "tube.glb", "--clip", "bend", "--implicit", "--fields", "fields.sphm", "-o", "again.pc2",
                      cwd=FOLDER)
        self.assertEqual(content("again.pc2"), content("soft.pc2"))
        self.succeeds("pose", "tube.glb", "--clip", "bend", "-o", "plain.pc2", cwd=FOLDER)
        self.assertEqual(content("plain.pc2"), content("soft-lbs.pc2"))
        # the morph targets, played by the reader of glTF, are the frames of the cache
        self.succeeds("convert", "soft.glb", "-o", "played.pc2", cwd=FOLDER)
        for a, b in zip(pc2("played.pc2"), pc2("soft.pc2")):
            self.close(a, b, 1e-5)

    def test_what_is_wrong_is_said(self):
        self.refuses(2, "-o is missing", "pose", "tube.glb", cwd=FOLDER)
        self.refuses(2, ".pc2, .mdd, .glb, .obj or .ply", "pose", "tube.glb", "-o", "x.stl", cwd=FOLDER)
        self.refuses(2, "one rig", "pose", "-o", "x.pc2", cwd=FOLDER)
        self.refuses(2, ".glb or .gltf", "pose", "tube.obj", "-o", "x.pc2", cwd=FOLDER)
        self.refuses(2, "--frames", "pose", "tube.glb", "--frames", "1:2", "-o", "x.obj", cwd=FOLDER)
        self.refuses(2, "--frame", "pose", "tube.glb", "--frame", 1, "-o", "x.pc2", cwd=FOLDER)
        self.refuses(2, "--method", "pose", "tube.glb", "--method", "cubic", "-o", "x.pc2", cwd=FOLDER)
        self.refuses(1, "no clip 'run': it has bend, twist", "pose", "tube.glb", "--clip", "run", "-o", "x.pc2", cwd=FOLDER)
        self.refuses(1, "there are 62", "pose", "tube.glb", "--frame", 99, "-o", "x.obj", cwd=FOLDER)
        self.refuses(1, "missing.glb", "pose", "missing.glb", "-o", "x.pc2", cwd=FOLDER)
        self.assertFalse([name for name in os.listdir(FOLDER) if name.startswith(("x.", "."))])


if __name__ == "__main__":
    main()
