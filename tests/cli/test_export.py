#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""export and sequences of surfaces: what is written is read by other parsers, and is the level; conservative levels
contain every vertex, by a search that shares nothing with the library and exact arithmetic."""
import json
import math
import os
import random
import shutil
import struct
import tempfile
import xml.etree.ElementTree as ElementTree
from fractions import Fraction

from support import Case, main

try:
    import yaml
except ImportError:
    yaml = None

FRAMES = 4
INPUT = ["--input", "creature.obj", "--cache", "creature.pc2"]


def setUpModule():
    global FOLDER, VERTICES
    FOLDER = tempfile.mkdtemp()
    case = Case()
    case.succeeds("demo", "-o", FOLDER, "--frame-count", FRAMES, "--resolution", 32, "--samples", 10, "--quiet")
    case.succeeds("level", "creature.sphm", "--spheres", 24, "-o", "l.json", cwd=FOLDER)
    cache = content("creature.pc2")
    count = int.from_bytes(cache[16:20], "little")
    values = struct.unpack(f"<{3 * count * FRAMES}f", cache[32:])
    VERTICES = [[values[3 * i:3 * i + 3] for i in range(f * count, (f + 1) * count)] for f in range(FRAMES)]


def tearDownModule():
    shutil.rmtree(FOLDER)


def content(name):
    with open(os.path.join(FOLDER, name), "rb") as file:
        return file.read()


def single(value):
    """The 32-bit float that a number in a file stands for."""
    return struct.unpack("f", struct.pack("f", float(value)))[0]


def level(name="l.json"):
    return json.loads(content(name), parse_float=single)


def blend(simplex, weights):
    """The sphere of these weights on [(center, radius), ...]."""
    center = [sum(w * c[k] for w, (c, _) in zip(weights, simplex)) for k in range(3)]
    return center, sum(w * r for w, (_, r) in zip(weights, simplex))


def excess(simplex, weights, x):
    center, radius = blend(simplex, weights)
    return math.dist(center, x) - radius


def search(simplex, x):
    """Weights of the least |x - c| - r: a grid that closes in on its best point."""
    n, best = len(simplex) - 1, [1 / len(simplex)] * len(simplex)
    step = 0.25
    value = excess(simplex, best, x)
    while step > 1e-9 and n > 0:
        moved = False
        for i in range(n + 1):
            for j in range(n + 1):
                take = min(step, best[i])
                if i == j or take <= 0:
                    continue
                trial = list(best)
                trial[i] -= take
                trial[j] += take
                found = excess(simplex, trial, x)
                if found < value:
                    best, value, moved = trial, found, True
        if not moved:
            step /= 2
    return best, value


def contains_exactly(simplex, weights, x):
    """|x - c(b)| <= r(b) without rounding."""
    weights = [max(Fraction(w), 0) for w in weights]
    weights = [w / sum(weights) for w in weights]
    center, radius = blend([([Fraction(k) for k in c], Fraction(r)) for c, r in simplex], weights)
    return sum((Fraction(k) - c) ** 2 for k, c in zip(x, center)) <= radius ** 2


def simplices(levelled, frame):
    spheres = list(zip(levelled["centers"][frame], levelled["radii"]))
    used = {i for s in levelled["edges"] + levelled["triangles"] for i in s}
    alone = [[i] for i in range(len(spheres)) if i not in used]
    return [[spheres[i] for i in s] for s in alone + levelled["edges"] + levelled["triangles"]]


class InFolder(Case):
    def succeeds(self, *arguments, cwd=None):
        return super().succeeds(*arguments, cwd=cwd or FOLDER)

    def refuses(self, code, culprit, *arguments, cwd=None):
        return super().refuses(code, culprit, *arguments, cwd=cwd or FOLDER)


class Coverage(InFolder):
    def test_the_uncovered_distance_is_that_of_a_search(self):
        told = self.json("export", "l.json", *INPUT, "-o", "p.json")
        self.assertEqual(told["frames"], FRAMES)
        worst = told["uncovered"]
        file = json.loads(content("p.json"))["coverage"]
        self.assertEqual((file["frame"], file["vertex"]), (worst["frame"], worst["vertex"]))
        self.assertEqual(file["largest_uncovered_distance"], worst["distance"])
        self.assertFalse(file["contains_all_vertices"])
        frame, x = worst["frame"], VERTICES[worst["frame"]][worst["vertex"]]
        self.assertAlmostEqual(min(search(s, x)[1] for s in simplices(level(), frame)), worst["distance"], 6)
        for v in range(0, len(VERTICES[frame]), 97):  # none is farther out
            near = min(search(s, VERTICES[frame][v])[1] for s in simplices(level(), frame))
            self.assertLess(near, worst["distance"] + 1e-9)

    def test_a_conservative_level_contains_the_vertices_exactly(self):
        told = self.json("export", "l.json", *INPUT, "--conservative", "--save-level", "c.json", "-o", "pc.json")
        before, after = level(), level("c.json")
        self.assertEqual(told["uncovered"]["uncovered"], 0)
        self.assertTrue(json.loads(content("pc.json"))["coverage"]["contains_all_vertices"])
        for key in ("centers", "edges", "triangles", "labels"):
            self.assertEqual(before[key], after[key])
        self.assertEqual(len(after["radii"]), 24)  # constant over frames, still
        growth = [b - a for a, b in zip(before["radii"], after["radii"])]
        self.assertGreaterEqual(min(growth), 0)
        self.assertAlmostEqual(max(growth), told["inflation"]["max_growth"], 6)
        self.assertLess(max(growth), 2 * told["uncovered_before"]["distance"])
        for frame in range(FRAMES):
            parts = simplices(after, frame)
            for x in VERTICES[frame][frame::7]:
                # one that has it by far needs no search
                if any(excess(s, [1 / len(s)] * len(s), x) < -1e-3 for s in parts):
                    continue
                found = sorted(((search(s, x), s) for s in parts), key=lambda f: f[0][1])[:3]
                self.assertTrue(any(contains_exactly(s, w, x) for (w, _), s in found), (frame, x, found[0][0]))

    def test_the_finest_level_is_conservative_and_stays_as_it_is(self):
        info = self.json("info", "creature.sphm")
        self.succeeds("level", "creature.sphm", "--spheres", info["vertices"], "-o", "all.sphm")
        told = self.json("export", "all.sphm", *INPUT, "--conservative", "-o", "all.ma")
        self.assertEqual((told["uncovered_before"]["distance"], told["inflation"]["grown"]), (0, 0))


class Formats(InFolder):
    def check_note(self, text, told):
        self.assertIn("largest uncovered distance", text)
        self.assertIn(repr(told["uncovered"]["distance"]).rstrip("0"), text)

    def test_primitives_are_those_of_the_level_in_each_frame(self):
        self.succeeds("export", "l.json", "--frames", "1::2", "-o", "p.json")
        file, wanted = json.loads(content("p.json"), parse_float=single), level()
        self.assertEqual((file["format"], file["version"]), ("sphmesh-primitives", 1))
        self.assertIsNone(file["coverage"])
        self.assertEqual([p["frame"] for p in file["poses"]], [1, 3])
        for pose in file["poses"]:
            for kind, key in (("capsules", "edges"), ("triangles", "triangles")):
                self.assertEqual([p["spheres"] for p in pose[kind]], wanted[key])
            for p in pose["spheres"] + pose["capsules"] + pose["triangles"]:
                self.assertEqual(p["centers"], [wanted["centers"][pose["frame"]][i] for i in p["spheres"]])
                self.assertEqual(p["radii"], [wanted["radii"][i] for i in p["spheres"]])

    def read_ma(self, name):
        lines = content(name).decode().splitlines()
        counts = [int(word) for word in lines[0].split()]
        rows = [line.split() for line in lines[1:1 + sum(counts)]]
        self.assertTrue(all(line.startswith("#") for line in lines[1 + sum(counts):]))
        v, e, f = (rows[sum(counts[:i]):sum(counts[:i + 1])] for i in range(3))
        for part, letter, length in ((v, "v", 5), (e, "e", 3), (f, "f", 4)):
            self.assertTrue(all(row[0] == letter and len(row) == length for row in part))
        return ([[single(w) for w in row[1:]] for row in v], *([[int(w) for w in row[1:]] for row in p] for p in (e, f)),
                lines[-1])

    def test_a_medial_mesh_has_the_spheres_and_all_edges(self):
        told = self.json("export", "l.json", *INPUT, "--frames", "2:3", "-o", "l.ma")
        v, e, f, note = self.read_ma("l.ma")
        wanted = level()
        self.assertEqual(v, [[*c, r] for c, r in zip(wanted["centers"][2], wanted["radii"])])
        self.assertEqual(f, wanted["triangles"])
        sides = {tuple(sorted((t[i], t[(i + 1) % 3]))) for t in f for i in range(3)}
        sides |= {tuple(sorted(edge)) for edge in wanted["edges"]}
        self.assertEqual([tuple(edge) for edge in e], sorted(sides))
        self.check_note(note, told)

    def test_frames_of_a_medial_mesh_go_to_numbered_files(self):
        told = self.json("export", "l.json", "--frames", "1:4:2", "-o", "seq.ma")
        self.assertEqual(told["files"], 2)
        for frame, name in ((1, "seq-0001.ma"), (3, "seq-0003.ma")):
            self.assertEqual([row[:3] for row in self.read_ma(name)[0]], level()["centers"][frame])
        self.succeeds("export", "l.json", "--frames", "1:2", "-o", "x%02d.ma")
        self.assertEqual(content("x01.ma"), content("seq-0001.ma"))

    def balls(self, name, link="sphmesh"):
        """[(center, radius)] by the reader of the format."""
        text = content(name).decode()
        if name.endswith(".yaml"):
            return [(b["center"], b["radius"]) for b in yaml.safe_load(text)["collision_spheres"][link]]
        root = ElementTree.fromstring(text)
        self.assertEqual((root.tag, root.get("name")), ("robot", link))
        if name.endswith(".srdf"):
            (part,) = root
            self.assertEqual((part.tag, part.get("link")), ("link_sphere_approximation", link))
            return [([float(w) for w in s.get("center").split()], float(s.get("radius"))) for s in part]
        (part,) = root
        self.assertEqual((part.tag, part.get("name")), ("link", link))
        return [([float(w) for w in c.find("origin").get("xyz").split()],
                 float(c.find("geometry/sphere").get("radius"))) for c in part.findall("collision")]

    def test_lists_of_spheres_are_the_same_in_every_format(self):
        names = ["s.srdf", "s.urdf"] + (["s.yaml"] if yaml else [])
        for name in names:
            told = self.json("export", "l.json", *INPUT, "--name", "arm_1", "-o", name)
            self.check_note(content(name).decode(), told)
            self.assertEqual(len(self.balls(name, "arm_1")), told["spheres"])
            self.assertEqual(self.balls(name, "arm_1"), self.balls(names[0], "arm_1"))
        if yaml is None:
            self.skipTest("without PyYAML: only the XML lists were compared")

    def solid_points(self, parts):
        """Points of the solid's boundary or of its inside."""
        draw = random.Random(5)
        for s in parts:
            for _ in range(150):
                w = [draw.random() ** 2 + 1e-9 for _ in s]
                c, r = blend(s, [x / sum(w) for x in w])
                d = [draw.gauss(0, 1) for _ in range(3)]
                yield [k + r * e / math.hypot(*d) for k, e in zip(c, d)]

    def test_spheres_keep_to_the_solid_within_the_gap(self):
        parts = simplices(level(), 0)
        for gap in (1, 4):
            for cover in ([], ["--cover"]):
                told = self.json("export", "l.json", "--gap", gap, *cover, "-o", "g.srdf")
                balls = self.balls("g.srdf")
                worst = max(min(math.dist(c, x) - r for c, r in balls) for x in self.solid_points(parts))
                self.assertLess(worst, 1e-6 if cover else told["gap"] + 1e-6)
                beyond = 1e-6 + (told["gap"] if cover else 0)
                for c, r in balls[::17]:  # the interpolated sphere of that centre
                    best = min(search(s, c)[1] for s in parts)
                    self.assertLess(r + best, beyond)

    def test_conservative_spheres_contain_the_vertices_of_their_frame(self):
        self.succeeds("export", "l.json", *INPUT, "--conservative", "--frames", "1:2", "-o", "c.srdf")
        balls = [([single(k) for k in c], single(r)) for c, r in self.balls("c.srdf")]
        for x in VERTICES[1]:
            near = min(balls, key=lambda b: math.dist(b[0], x) - b[1])
            self.assertTrue(contains_exactly([near], [1], x))

    def test_a_glb_has_the_primitives_as_extras(self):
        told = self.json("export", "l.json", *INPUT, "-o", "l.glb")
        file, wanted = content("l.glb"), level()
        size = int.from_bytes(file[12:16], "little")
        gltf = json.loads(file[20:20 + size], parse_float=single)
        nodes = [(i, n["extras"]["sphmesh"], n) for i, n in enumerate(gltf["nodes"]) if "extras" in n]
        spheres = {e["sphere"]: (i, e, n) for i, e, n in nodes if e["type"] == "sphere"}
        self.assertEqual([spheres[i][1]["radius"] for i in range(24)], wanted["radii"])
        self.assertEqual([spheres[i][2]["translation"] for i in range(24)], wanted["centers"][0])
        for kind, key in (("capsule", "edges"), ("triangle", "triangles")):
            found = [e for _, e, _ in nodes if e["type"] == kind]
            self.assertEqual([e["nodes"] for e in found], [[spheres[i][0] for i in s] for s in wanted[key]])
            self.assertEqual([e["radii"] for e in found], [[wanted["radii"][i] for i in s] for s in wanted[key]])
        reached = set()
        queue = list(gltf["scenes"][0]["nodes"])
        while queue:
            node = queue.pop()
            self.assertNotIn(node, reached)
            reached.add(node)
            queue += gltf["nodes"][node].get("children", [])
        self.assertEqual(len(reached), len(gltf["nodes"]))
        said = gltf["scenes"][0]["extras"]["sphmesh"]
        self.assertEqual(said["frames"], FRAMES)
        self.assertEqual(said["coverage"]["vertex"], told["uncovered"]["vertex"])
        info = self.json("info", "l.glb")  # our own reader still takes it for a mesh
        self.assertEqual(info["frames"], FRAMES)

    def test_wrong_usage_is_refused_with_what_is_missing(self):
        self.refuses(2, "--input is missing", "export", "l.json", "--conservative", "-o", "x.json")
        self.refuses(2, "'x.txt' does not end in", "export", "l.json", "-o", "x.txt")
        self.refuses(2, "--gap", "export", "l.json", "--gap", 1, "-o", "x.json")
        self.refuses(2, "none from 9 on", "export", "l.json", "--frames", "9:", "-o", "x.json")
        self.refuses(2, "-o is missing", "export", "l.json")
        self.refuses(2, "--cache: it goes with --input", "export", "l.json", "--cache", "creature.pc2", "-o", "x.json")
        self.refuses(1, "1 frames, the level 4", "export", "l.json", "--input", "creature.obj", "-o", "x.json")
        self.refuses(1, "the name of a link", "export", "l.json", "--name", "a<b", "-o", "x.srdf")
        self.assertFalse([n for n in os.listdir(FOLDER) if n.startswith("x.")])


class Sequences(InFolder):
    def test_surfaces_of_frames_are_those_of_each_frame_alone(self):
        told = self.json("surface", "l.json", "--frames", "0:4:3", "--resolution", 24, "-o", "m.ply")
        self.assertEqual(told["files"], 2)
        for frame, name in ((0, "m-0000.ply"), (3, "m-0003.ply")):
            self.succeeds("surface", "l.json", "--frame", frame, "--resolution", 24, "-o", "one.ply")
            self.assertEqual(content(name), content("one.ply"))
            info = self.json("info", name)
            self.assertEqual(info["check"]["boundary_edges"], 0)
        self.succeeds("surface", "l.json", "--frames", "3:", "--resolution", 24, "-o", "m%d.ply")
        self.assertEqual(content("m3.ply"), content("m-0003.ply"))
        self.refuses(2, "one of them", "surface", "l.json", "--frames", ":", "--frame", 1, "-o", "x.ply")
        self.refuses(2, "none from 7 on", "surface", "l.json", "--frames", "7:", "-o", "x.ply")


if __name__ == "__main__":
    main()
