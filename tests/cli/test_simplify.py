#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sphmesh simplify on a rig that is made here: what a file has besides its meshes is there in its levels too."""
import json
import math
import os
import shutil
import struct
import tempfile

from support import Case, main

SIDES, RINGS, FRAMES = 24, 31, 5
IMAGE = bytes.fromhex("89504e470d0a1a0a0000000d49484452000000010000000108060000001f15c4890000000d49444154789c63f8cfc0f01f"
                      "000500050301ff1b2b0c5e0000000049454e44ae426082")
FORMATS = {5126: "f", 5123: "H", 5121: "B", 5125: "I"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def tube():
    """Positions, normals, texture, joints, weights; the last side of each ring lies on the first: a seam."""
    rows = []
    for r in range(RINGS):
        x = 4 * r / (RINGS - 1) - 2
        share = min(1, max(0, x + 0.5))
        for s in range(SIDES + 1):
            c, d = math.cos(2 * math.pi * (s % SIDES) / SIDES), math.sin(2 * math.pi * (s % SIDES) / SIDES)
            radius = 0.5 + 0.03 * math.sin(9 * x + 2 * math.pi * 3 * (s % SIDES) / SIDES)
            rows.append(((x, radius * c, radius * d), (0, c, d), (s / SIDES, r / (RINGS - 1)), (0, 1, 0, 0),
                         (1 - share, share, 0, 0), (0, 0.1 * c, 0.1 * d)))
    return rows


def faces(first, last):
    out = []
    for r in range(first, last):
        for s in range(SIDES):
            a, n = r * (SIDES + 1) + s, SIDES + 1
            out += [a, a + n, a + 1, a + 1, a + n, a + n + 1]
    return out


def write_rig(path):
    """Two primitives of one skinned mesh over the same vertices, a morph target, and a rigid box with a lens below it."""
    binary, views, accessors = b"", [], []

    def view(data):
        nonlocal binary
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
        binary += data + bytes(-len(data) % 4)
        return len(views) - 1

    def add(kind, component, rows, **more):
        flat = [x for row in rows for x in (row if isinstance(row, (tuple, list)) else (row,))]
        accessors.append({"bufferView": view(struct.pack(f"<{len(flat)}{FORMATS[component]}", *flat)), "type": kind,
                          "componentType": component, "count": len(flat) // WIDTHS[kind], **more})
        return len(accessors) - 1

    rows = list(zip(*tube()))
    bounds = {"min": [min(c) for c in zip(*rows[0])], "max": [max(c) for c in zip(*rows[0])]}
    attributes = {"POSITION": add("VEC3", 5126, rows[0], **bounds), "NORMAL": add("VEC3", 5126, rows[1]),
                  "TEXCOORD_0": add("VEC2", 5126, rows[2]), "JOINTS_0": add("VEC4", 5121, rows[3]),
                  "WEIGHTS_0": add("VEC4", 5126, rows[4])}
    target = {"POSITION": add("VEC3", 5126, rows[5], min=[0, -0.1, -0.1], max=[0, 0.1, 0.1])}
    box = [(x, y, z) for x in (-0.2, 0.2) for y in (1, 1.4) for z in (-0.2, 0.2)]
    sides = [0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3]
    turn = [(0, 0, math.sin(0.15 * f), math.cos(0.15 * f)) for f in range(FRAMES)]
    identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    primitive = {"attributes": attributes, "targets": [target]}
    document = {
        "asset": {"version": "2.0", "copyright": "nobody"}, "scene": 0, "scenes": [{"nodes": [0, 1, 3]}],
        "extras": {"studio": "a", "list": [1, {"b": None}]},
        "nodes": [{"name": "body", "mesh": 0, "skin": 0}, {"name": "hip", "children": [2]}, {"name": "knee"},
                  {"name": "hat", "mesh": 1, "children": [4]}, {"name": "lens", "translation": [0, 1, 0]}],
        "meshes": [{"name": "body", "weights": [0.5], "primitives": [
            {**primitive, "indices": add("SCALAR", 5123, faces(0, 10)), "material": 1},
            {**primitive, "indices": add("SCALAR", 5123, faces(10, RINGS - 1)), "material": 0}]},
            {"name": "hat", "primitives": [{"attributes": {"POSITION": add("VEC3", 5126, box, min=[-0.2, 1, -0.2],
                                                                         max=[0.2, 1.4, 0.2])},
                                            "indices": add("SCALAR", 5121, sides)}]}],
        "materials": [{"name": "cloth", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}, {"name": "skin"}],
        "textures": [{"source": 0}], "images": [{"bufferView": view(IMAGE), "mimeType": "image/png"}],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": add("MAT4", 5126, [identity, identity])}],
        "animations": [{"name": "nod", "channels": [{"sampler": 0, "target": {"node": 2, "path": "rotation"}}],
                        "samplers": [{"input": add("SCALAR", 5126, [f / 24 for f in range(FRAMES)], min=[0],
                                                   max=[(FRAMES - 1) / 24]), "output": add("VEC4", 5126, turn)}]}],
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(binary)}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)


class Glb:
    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        size = struct.unpack_from("<I", data, 12)[0]
        self.json = json.loads(data[20:20 + size])
        self.binary = data[28 + size:]

    def view(self, index):
        v = self.json["bufferViews"][index]
        return self.binary[v.get("byteOffset", 0):][:v["byteLength"]]

    def rows(self, index):
        a = self.json["accessors"][index]
        width = WIDTHS[a["type"]]
        flat = struct.unpack_from(f"<{a['count'] * width}{FORMATS[a['componentType']]}", self.view(a["bufferView"]))
        return [flat[i:i + width] for i in range(0, len(flat), width)]

    def primitives(self, mesh):
        return self.json["meshes"][mesh]["primitives"]


def setUpModule():
    global FOLDER, SUMMARY
    FOLDER = tempfile.mkdtemp()
    write_rig(os.path.join(FOLDER, "rig.glb"))
    SUMMARY = Case().json("simplify", "rig.glb", "--ratio", "40,15", "-o", "lod.glb", cwd=FOLDER)


def tearDownModule():
    shutil.rmtree(FOLDER)


def opened(name):
    return Glb(os.path.join(FOLDER, name))


class Simplify(Case):
    def test_levels_are_as_large_as_asked_for_and_files_say_the_same(self):
        points, copies = RINGS * SIDES + 8, RINGS + SIDES + 1  # along the seam, and where the two materials meet
        self.assertEqual((SUMMARY["points"], SUMMARY["vertices"]), (points, points + RINGS))
        self.assertEqual(SUMMARY["triangles"], 2 * SIDES * (RINGS - 1) + 12)
        for level, share, name in zip(SUMMARY["levels"], (0.40, 0.15), ("lod-1.glb", "lod-2.glb")):
            self.assertEqual(level["file"], name)
            self.assertLessEqual(level["vertices"], share * SUMMARY["vertices"] + 0.5)
            self.assertGreater(level["vertices"], share * SUMMARY["vertices"] - 4)
            self.assertLess(level["error_percent"], 1)
            document = opened(name)
            triangles = sum(len(document.rows(p["indices"])) // 3 for m in (0, 1) for p in document.primitives(m))
            vertices = sum(len(document.rows(p["attributes"]["POSITION"])) for m in (0, 1) for p in document.primitives(m))
            self.assertEqual(triangles, level["triangles"])
            self.assertTrue(level["vertices"] <= vertices <= level["vertices"] + copies)

    def test_what_is_no_mesh_stays_as_it_was(self):
        before = opened("rig.glb")
        for name in ("lod.glb", "lod-1.glb", "lod-2.glb"):
            after = opened(name)
            for key in ("asset", "scene", "scenes", "extras", "materials", "textures"):
                self.assertEqual(after.json[key], before.json[key], key)
            self.assertEqual(after.view(after.json["images"][0]["bufferView"]), IMAGE)
            self.assertEqual(after.json["skins"][0]["joints"], [1, 2])
            self.assertEqual(after.rows(after.json["skins"][0]["inverseBindMatrices"]),
                             before.rows(before.json["skins"][0]["inverseBindMatrices"]))
            clips = [d.json["animations"][0] for d in (before, after)]
            self.assertEqual(clips[0]["channels"], clips[1]["channels"])
            for key in ("input", "output"):
                self.assertEqual(before.rows(clips[0]["samplers"][0][key]), after.rows(clips[1]["samplers"][0][key]))

    def test_primitives_keep_materials_texture_normals_and_morph_targets(self):
        for name in ("lod-1.glb", "lod-2.glb"):
            document = opened(name)
            self.assertEqual([p.get("material") for p in document.primitives(0)], [1, 0])
            self.assertEqual(document.json["meshes"][0]["weights"], [0.5])
            for p in document.primitives(0):
                a = p["attributes"]
                self.assertEqual(sorted(a), ["JOINTS_0", "NORMAL", "POSITION", "TEXCOORD_0", "WEIGHTS_0"])
                morphs = document.rows(p["targets"][0]["POSITION"])
                for index, rows in ((a["POSITION"], document.rows(a["POSITION"])), (p["targets"][0]["POSITION"], morphs)):
                    accessor = document.json["accessors"][index]
                    told = [struct.unpack("<3f", struct.pack("<3f", *accessor[key])) for key in ("min", "max")]
                    self.assertEqual(told, [tuple(map(bound, zip(*rows))) for bound in (min, max)])
                for row in zip(*(document.rows(a[key]) for key in sorted(a)), morphs):
                    joints, normal, (x, y, z), (u, v), weights, morph = row
                    angle = math.atan2(z, y) / (2 * math.pi)
                    self.assertLess(abs((angle - u + 0.5) % 1 - 0.5), 0.04)
                    self.assertLess(abs(v - (x + 2) / 4), 0.04)
                    self.assertAlmostEqual(math.dist(normal, (0, 0, 0)), 1, 5)
                    self.assertAlmostEqual(sum(weights), 1, 6)
                    self.assertTrue(all(j == 0 or w > 0 for j, w in zip(joints, weights)))
                    self.assertTrue(max(joints) <= 1 and min(weights) >= 0)
                    # POSITION has no part of the target, which engines add by its weight
                    self.assertLess(abs(math.hypot(y, z) - 0.5), 0.068)
                    self.assertLess(math.hypot(*morph), 0.101)

    def test_one_file_has_all_levels_after_the_mesh_as_it_was(self):
        document = opened("lod.glb")
        nodes, names = document.json["nodes"], ["body", "body_LOD1", "body_LOD2"]
        self.assertIn("MSFT_lod", document.json["extensionsUsed"])
        chain = [0] + nodes[0]["extensions"]["MSFT_lod"]["ids"]
        self.assertEqual([nodes[i]["name"] for i in chain], names)
        self.assertEqual([nodes[i]["skin"] for i in chain], [0, 0, 0])
        sizes = [sum(len(document.rows(p["indices"])) for p in document.primitives(nodes[i]["mesh"])) for i in chain]
        self.assertEqual(sizes[0], 6 * SIDES * (RINGS - 1))
        self.assertTrue(sizes[0] > sizes[1] > sizes[2] > 0)
        coverage = nodes[0]["extras"]["MSFT_screencoverage"]
        self.assertTrue(1 >= coverage[0] >= coverage[1] >= coverage[2] == 0)
        # the hat has a child of its own, which must not go with it: a new child has the mesh and its levels
        self.assertNotIn("mesh", nodes[3])
        self.assertEqual(nodes[3]["children"][0], 4)
        hat = nodes[nodes[3]["children"][1]]
        self.assertEqual(document.json["meshes"][hat["mesh"]]["name"], "hat")
        self.assertTrue(all("mesh" in nodes[i] for i in hat["extensions"]["MSFT_lod"]["ids"]))

    def posed(self, name):
        """Vertices of all frames, by `sphmesh pose`."""
        self.succeeds("pose", name, "--fps", 24, "-o", "posed.pc2", "--quiet", cwd=FOLDER)
        with open(os.path.join(FOLDER, "posed.pc2"), "rb") as file:
            data = file.read()
        count, frames = struct.unpack_from("<I", data, 16)[0], struct.unpack_from("<I", data, 28)[0]
        self.assertEqual(frames, FRAMES)
        flat = struct.unpack_from(f"<{3 * count * frames}f", data, 32)
        return [[flat[3 * (f * count + i):][:3] for i in range(count)] for f in range(frames)]

    def test_levels_are_posed_where_the_mesh_is(self):
        before, after = self.posed("rig.glb"), self.posed("lod-1.glb")
        for f in range(FRAMES):
            distances = [min(math.dist(p, q) for q in before[f]) for p in after[f]]
            self.assertLess(max(distances), 0.12)  # vertices of the input are this far apart

    def test_by_vertices_triangles_and_error(self):
        few = self.json("simplify", "rig.glb", "--vertices", 100, "-o", "v.glb", cwd=FOLDER)
        self.assertTrue(95 < few["levels"][0]["vertices"] <= 100)
        few = self.json("simplify", "rig.glb", "--triangles", 300, "-o", "t.glb", cwd=FOLDER)
        self.assertTrue(290 < few["levels"][0]["triangles"] <= 300)
        few = self.json("simplify", "rig.glb", "--max-error", 0.2, "-o", "e.glb", cwd=FOLDER)
        self.assertTrue(0.1 < few["levels"][0]["error_percent"] <= 0.2)
        fewer = self.json("simplify", "rig.glb", "--max-error", 0.5, "--influences", 1, "-o", "e.glb", cwd=FOLDER)
        self.assertLess(fewer["levels"][0]["vertices"], few["levels"][0]["vertices"])
        self.assertEqual(fewer["influences"], 1)

    def test_the_same_on_any_number_of_threads(self):
        for threads in (1, 2, 4):
            self.succeeds("simplify", "rig.glb", "--ratio", 20, "--threads", threads, "-q", "-o", f"n{threads}.glb", cwd=FOLDER)
        files = [open(os.path.join(FOLDER, f"n{n}.glb"), "rb").read() for n in (1, 2, 4)]
        self.assertTrue(files[0] == files[1] == files[2])

    def test_images_beside_the_file_come_along_to_another_folder(self):
        inside = os.path.join(FOLDER, "other")
        os.makedirs(inside, exist_ok=True)
        source = opened("rig.glb")
        source.json["images"] = [{"uri": "a%20b.png"}]
        source.json["buffers"][0]["uri"] = "rig.bin"
        for name, data in (("a b.png", IMAGE), ("rig.bin", source.binary), ("rig.gltf", json.dumps(source.json).encode())):
            with open(os.path.join(FOLDER, name), "wb") as file:
                file.write(data)
        self.succeeds("simplify", "rig.gltf", "--ratio", 20, "-q", "-o", "here.glb", cwd=FOLDER)
        self.assertEqual(opened("here.glb").json["images"], [{"uri": "a%20b.png"}])
        self.succeeds("simplify", "rig.gltf", "--ratio", 20, "-q", "-o", "other/there.glb", cwd=FOLDER)
        there = opened("other/there.glb")
        self.assertEqual(there.json["images"][0]["mimeType"], "image/png")
        self.assertEqual(there.view(there.json["images"][0]["bufferView"]), IMAGE)

    def test_what_is_wrong_is_refused(self):
        for culprit, arguments in (("one of --ratio", ["rig.glb", "-o", "x.glb"]),
                                   ("one of --ratio", ["rig.glb", "--ratio", "5", "--vertices", "7", "-o", "x.glb"]),
                                   ("--ratio", ["rig.glb", "--ratio", "5,,7", "-o", "x.glb"]),
                                   ("--ratio", ["rig.glb", "--ratio", "101", "-o", "x.glb"]),
                                   ("--vertices", ["rig.glb", "--vertices", "1.5", "-o", "x.glb"]),
                                   ("--triangles", ["rig.glb", "--triangles", "-4", "-o", "x.glb"]),
                                   ("--max-error", ["rig.glb", "--max-error", "nan", "-o", "x.glb"]),
                                   ("-o", ["rig.glb", "--ratio", "5"]),
                                   ("x.obj", ["rig.glb", "--ratio", "5", "-o", "x.obj"]),
                                   ("rig.obj", ["rig.obj", "--ratio", "5", "-o", "x.glb"])):
            self.refuses(2, culprit, "simplify", *arguments, cwd=FOLDER)
        self.refuses(1, "nothing.glb", "simplify", "nothing.glb", "--ratio", 5, "-o", "x.glb", cwd=FOLDER)
        self.refuses(1, "nowhere", "simplify", "rig.glb", "--ratio", 5, "-o", "nowhere/x.glb", cwd=FOLDER)
        self.refuses(1, "no clip", "simplify", "rig.glb", "--ratio", 5, "--clip", "jump", "-o", "x.glb", cwd=FOLDER)
        self.assertFalse(os.path.exists(os.path.join(FOLDER, "x.glb")))


if __name__ == "__main__":
    main()
