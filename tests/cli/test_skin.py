#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sphmesh skin: the errors that it tells are those of the file that it writes, played by a small reader of our own."""
import json
import math
import os
import shutil
import struct
import tempfile
import urllib.parse

from support import Case, main

FRAMES = 6
INPUT = ["creature.obj", "--cache", "creature.pc2"]


def setUpModule():
    global FOLDER
    FOLDER = tempfile.mkdtemp()
    Case().succeeds("demo", "-o", FOLDER, "--frame-count", FRAMES, "--resolution", 32, "--samples", 10, "--quiet")


def tearDownModule():
    shutil.rmtree(FOLDER)


def content(name):
    with open(os.path.join(FOLDER, name), "rb") as file:
        return file.read()


def multiply(a, b):
    return [[sum(a[r][k] * b[k][c] for k in range(4)) for c in range(4)] for r in range(4)]


def matrix(t, q):
    x, y, z, w = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), t[0]],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), t[1]],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), t[2]], [0, 0, 0, 1]]


class Rig:
    """A rig as its file has it."""
    KINDS = {5121: ("B", 255), 5123: ("H", 65535), 5125: ("I", 1), 5126: ("f", 1)}

    def __init__(self, name):
        data = content(name)
        if name.endswith(".glb"):
            size = struct.unpack("<I", data[12:16])[0]
            self.doc, self.binary = json.loads(data[20:20 + size]), data[28 + size:]
        else:
            self.doc = json.loads(data)
            self.binary = content(urllib.parse.unquote(self.doc["buffers"][0]["uri"]))
        self.mesh = self.doc["meshes"][0]["primitives"][0]["attributes"]

    def values(self, number):
        accessor = self.doc["accessors"][number]
        letter, one = self.KINDS[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[accessor["type"]]
        start = self.doc["bufferViews"][accessor["bufferView"]]["byteOffset"] + accessor["byteOffset"]
        flat = struct.unpack_from(f"<{accessor['count'] * width}{letter}", self.binary, start)
        scale = one if accessor.get("normalized") else 1
        return [[v / scale for v in flat[i:i + width]] for i in range(0, len(flat), width)]

    def influences(self):
        """For each vertex its joints and weights, of all sets."""
        out = [[] for _ in range(self.doc["accessors"][self.mesh["POSITION"]]["count"])]
        for n in range(64):
            if f"JOINTS_{n}" not in self.mesh:
                return out
            for pairs, joints, weights in zip(out, self.values(self.mesh[f"JOINTS_{n}"]),
                                              self.values(self.mesh[f"WEIGHTS_{n}"])):
                pairs += [(int(j), w) for j, w in zip(joints, weights) if w > 0]

    def play(self, clip):
        """The vertices of each frame of a clip, at its keys."""
        doc, skin = self.doc, self.doc["skins"][0]
        parent = {child: i for i, node in enumerate(doc["nodes"]) for child in node.get("children", ())}
        tracks = {}
        for channel in doc["animations"][clip]["channels"]:
            sampler = doc["animations"][clip]["samplers"][channel["sampler"]]
            frames = len(self.values(sampler["input"]))
            tracks[channel["target"]["node"], channel["target"]["path"]] = self.values(sampler["output"])
        binds = [[[m[4 * c + r] for c in range(4)] for r in range(4)] for m in self.values(skin["inverseBindMatrices"])]
        rest, influences = self.values(self.mesh["POSITION"]), self.influences()
        for frame in range(frames):
            worlds = {}

            def world(node):
                if node not in worlds:
                    still = doc["nodes"][node]
                    local = matrix(tracks[node, "translation"][frame] if (node, "translation") in tracks
                                   else still.get("translation", (0, 0, 0)),
                                   tracks[node, "rotation"][frame] if (node, "rotation") in tracks
                                   else still.get("rotation", (0, 0, 0, 1)))
                    worlds[node] = multiply(world(parent[node]), local) if node in parent else local
                return worlds[node]
            moves = [multiply(world(j), b) for j, b in zip(skin["joints"], binds)]
            yield [[sum(w * (moves[j][r][0] * x + moves[j][r][1] * y + moves[j][r][2] * z + moves[j][r][3])
                        for j, w in pairs) for r in range(3)] for (x, y, z), pairs in zip(rest, influences)]


def cache_frames():
    data = content("creature.pc2")
    count = struct.unpack("<I", data[16:20])[0]
    values = struct.unpack(f"<{(len(data) - 32) // 4}f", data[32:])
    return [[values[3 * (f * count + v):3 * (f * count + v) + 3] for v in range(count)] for f in range(FRAMES)]


class Skin(Case):
    def skin(self, *arguments, output="rig.glb"):
        return self.json("skin", *INPUT, *arguments, "-o", output, cwd=FOLDER)

    def check(self, told, name, first_frames):
        """Errors of the file, played, against those that were told; which frames of the input a clip begins with."""
        rig, truth = Rig(name), cache_frames()
        self.assertEqual(len(rig.doc["animations"]), len(told["clips"]))
        for number, (clip, first) in enumerate(zip(told["clips"], first_frames)):
            squares, most, frames = [], 0, 0
            for f, frame in enumerate(rig.play(number)):
                off = [math.dist(p, q) for p, q in zip(frame, truth[first + f])]
                squares.append(sum(d * d for d in off) / len(off))
                most, frames = max(most, *off), frames + 1
                rmse = 100 * math.sqrt(squares[-1]) / told["bounding_diagonal"]
                self.assertAlmostEqual(clip["rmse_percent_per_frame"][f], rmse, 4)
            self.assertEqual(frames, clip["frames"])
            self.assertAlmostEqual(clip["max"], most, 6)
            self.assertAlmostEqual(clip["rmse"], math.sqrt(sum(squares) / frames), 6)
        self.assertEqual(told["max"], max(clip["max"] for clip in told["clips"]))
        return rig

    def test_the_errors_told_are_those_of_the_file(self):
        told = self.skin("--spheres", 16)
        rig = self.check(told, "rig.glb", [0])
        self.assertEqual((told["bones"], told["joints"], told["mode"]), (16, 16, "mixed"))
        self.assertEqual(told["frames"], FRAMES)
        self.assertLess(told["rmse_percent"], 1)
        self.assertEqual(told["bytes"], len(content("rig.glb")))
        self.assertEqual(max(map(len, rig.influences())), told["influences"])

    def test_whole_numbers_lists_and_clips_are_told_of_as_written(self):
        told = self.skin("--level", "creature.sphm", "--spheres", 10, "--mode", "animation", "--influences", 6, "--weights",
                         "u8", "--flat", "--single-root", "--clips", "late=3:6,early=:2", "--fps", 25, output="a b.gltf")
        rig = self.check(told, "a b.gltf", [3, 0])
        self.assertEqual([clip["name"] for clip in told["clips"]], ["late", "early"])
        self.assertEqual([a["name"] for a in rig.doc["animations"]], ["late", "early"])
        self.assertEqual(told["joints"], 11)
        self.assertEqual(told["bytes"], len(content("a b.gltf")) + len(content("a b.bin")))
        self.assertEqual(rig.doc["nodes"][10]["name"], "root")
        self.assertEqual(sorted(rig.doc["nodes"][10]["children"]), list(range(10)))
        times = rig.values(rig.doc["animations"][0]["samplers"][0]["input"])
        self.assertEqual([round(25 * t) for t, in times], [0, 1, 2])

    def test_a_rig_of_a_level_is_that_of_its_hierarchy(self):
        self.skin("--level", "level-20.json", output="level.glb")
        self.skin("--level", "creature.sphm", "--spheres", 20, output="hierarchy.glb")
        self.skin("--spheres", 20, "--threads", 1, output="built.glb")
        self.assertEqual(content("level.glb"), content("hierarchy.glb"))
        self.assertEqual(content("level.glb"), content("built.glb"))

    def test_its_own_clips_and_names_come_back_from_a_glTF(self):
        self.skin("--spheres", 8, "--clips", "stand=0:2,walk=2:6", output="two.glb")
        told = self.json("skin", "two.glb", "--spheres", 8, "--fps", 30, "-o", "again.glb", cwd=FOLDER)
        self.assertEqual([(c["name"], c["frames"]) for c in told["clips"]], [("stand", 2), ("walk", 4)])
        self.assertLess(told["rmse_percent"], 1)

    def test_the_root_is_the_bone_that_is_asked_for(self):
        self.skin("--level", "level-10.json", "--root", 7, output="root.glb")
        self.assertEqual(Rig("root.glb").doc["scenes"][0]["nodes"][0], 7)
        self.skin("--level", "level-10.json", "--root", "heaviest", output="root.glb")

    def test_vertices_that_count_alike_are_nearer_on_the_whole(self):
        errors = [self.json("skin", *INPUT, "--spheres", 12, "--mode", "animation", *how, "-o", "uniform.glb",
                            cwd=FOLDER)["rmse"] for how in ((), ("--uniform",))]
        self.assertLess(errors[1], errors[0])

    def test_the_table_has_a_row_per_clip(self):
        text = self.succeeds("skin", *INPUT, "--level", "level-10.json", "--mode", "geometric", "--clips", "a=:3,b=3:",
                             "-o", "text.glb", cwd=FOLDER).stdout
        self.assertRegex(text, r"(?m)^rig: +10 bones, 4 influences")
        for name, frames in (("a", 3), ("b", 3), ("together", 6)):
            self.assertRegex(text, rf"(?m)^ +{name} +{frames} +\d+\.\d+ +\d+\.\d+$")
        self.assertIn("wrote:      text.glb", text)

    def test_what_does_not_fit_is_refused_by_name(self):
        def refuses(code, culprit, *arguments):
            self.refuses(code, culprit, "skin", *INPUT, *arguments, cwd=FOLDER)
        refuses(2, "-o is missing", "--spheres", 4)
        refuses(2, "'x.fbx' does not end in", "--spheres", 4, "-o", "x.fbx")
        refuses(2, "one of --level and --spheres", "-o", "x.glb")
        refuses(2, "--level: 'x.obj'", "--level", "x.obj", "-o", "x.glb")
        refuses(2, "say how many spheres", "--level", "creature.sphm", "-o", "x.glb")
        refuses(2, "is a level", "--level", "level-10.json", "--spheres", 4, "-o", "x.glb")
        refuses(2, "--spheres: 999999", "--spheres", 999999, "-o", "x.glb")
        refuses(2, "--root: 'x'", "--spheres", 4, "--root", "x", "-o", "x.glb")
        refuses(2, "--root: there are bones 0 to 3", "--spheres", 4, "--root", 4, "-o", "x.glb")
        refuses(2, "--clips: 'walk' is not NAME=A:B", "--spheres", 4, "--clips", "walk", "-o", "x.glb")
        refuses(2, "the input has frames 0 to 5", "--spheres", 4, "--clips", "walk=2:7", "-o", "x.glb")
        refuses(2, "'5:3' is not A:B", "--spheres", 4, "--clips", "a=:2,walk=5:3", "-o", "x.glb")
        refuses(2, "did you mean 'mixed'", "--spheres", 4, "--mode", "mixt", "-o", "x.glb")
        refuses(1, "level-10.json: has 6 frames, the input 3", "--level", "level-10.json", "--frames", "::2", "-o", "x.glb")
        refuses(1, "No such file", "--level", "nowhere.json", "-o", "x.glb")
        refuses(1, "No such file", "--spheres", 4, "-o", "nowhere/x.glb")
        self.assertFalse(os.path.exists(os.path.join(FOLDER, "x.glb")))


if __name__ == "__main__":
    main()
