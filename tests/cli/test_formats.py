#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""One animation in every format that is read: the options for input do the same to all of them."""
import base64
import json
import os
import struct
import sys
import tempfile

from support import Case, main

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "io", "fixtures"))
import make_alembic  # noqa: E402

FRAMES, RATE = 6, 30
FACES = [(0, 1, 2), (3, 5, 4)]  # 1 and 5, 2 and 4 coincide in all frames: a seam


def frame(f):
    a, b, c, d = (0, 0, 0), (1, 0, f / 4), (0, 1, f / 2), (1, 1, f)
    return [a, b, c, d, c, b]


def flat(points):
    return [x for p in points for x in p]


def gltf():
    """Morph targets, one for each frame, each on in its frame alone."""
    data, views, accessors = bytearray(), [], []

    def add(values, kind, width, code="f", component=5126):
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": 4 * len(values)})
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "type": kind,
                          "count": len(values) // width})
        data.extend(struct.pack(f"<{len(values)}{code}", *values))
        return len(accessors) - 1
    rest = flat(frame(0))
    position, indices = add(rest, "VEC3", 3), add(flat(FACES), "SCALAR", 1, "I", 5125)
    targets = [{"POSITION": add([x - r for x, r in zip(flat(frame(f)), rest)], "VEC3", 3)} for f in range(1, FRAMES)]
    times = add([f / RATE for f in range(FRAMES)], "SCALAR", 1)
    weights = add([float(f == t) for f in range(FRAMES) for t in range(1, FRAMES)], "SCALAR", 1)
    primitive = {"attributes": {"POSITION": position}, "indices": indices, "targets": targets}
    uri = "data:application/octet-stream;base64," + base64.b64encode(bytes(data)).decode()
    return json.dumps({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [primitive]}], "buffers": [{"uri": uri, "byteLength": len(data)}],
        "bufferViews": views, "accessors": accessors,
        "animations": [{"name": "walk", "samplers": [{"input": times, "output": weights}],
                        "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]}]})


class Formats(Case):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        for f in range(FRAMES):
            lines = [" ".join(map(str, p)) for p in frame(f)]
            self.write(f"s{f}.obj", "".join(f"v {v}\n" for v in lines) + "f 1 2 3\nf 4 6 5\n")
            self.write(f"s{f}.off", "OFF\n6 2 0\n" + "\n".join(lines) + "\n3 0 1 2\n3 3 5 4\n")
            self.write(f"s{f}.ply", "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
                       "property float z\nelement face 2\nproperty list uchar int vertex_index\nend_header\n"
                       + "\n".join(lines) + "\n3 0 1 2\n3 3 5 4\n")
        self.write("a.gltf", gltf())
        make_alembic.FOLDER = self.folder
        make_alembic.Archive([(1.0, [0.0]), (1 / RATE, [0.0])]).write(
            "a.abc", [make_alembic.mesh("walk", [frame(f) for f in range(FRAMES)], FACES, 1)])
        for ending in ("pc2", "mdd"):
            self.succeeds("convert", self.path("s%d.obj"), "-o", self.path("c." + ending))
        self.inputs = {
            "OBJ": ["s%d.obj"], "OFF": ["s*.off"], "PLY": ["s%d.ply"], "PC2": ["s0.obj", "--cache", "c.pc2"],
            "MDD": ["s0.ply", "--cache", "c.mdd"], "glTF": ["a.gltf"], "Alembic": ["a.abc"]}

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)

    def convert(self, name, *options):
        """Triangles, and the points of each frame."""
        self.succeeds("convert", *self.inputs[name], *options, "-o", "out.obj", "--quiet", cwd=self.folder)
        with open(self.path("out.obj")) as file:
            triangles = [tuple(int(i) - 1 for i in line.split()[1:]) for line in file if line.startswith("f ")]
        with open(self.path("out.pc2"), "rb") as file:
            data = file.read()
        points, _, _, count = struct.unpack("<iffi", data[16:32])
        values = struct.unpack(f"<{3 * points * count}f", data[32:])
        rows = [tuple(values[i:i + 3]) for i in range(0, len(values), 3)]
        return triangles, [rows[f * points:(f + 1) * points] for f in range(count)]

    def check(self, transform, frames, *options, weld=True):
        for name in self.inputs:
            triangles, found = self.convert(name, *options, *(["--weld"] if weld else []))
            self.assertEqual((len(triangles), len(found)), (2, len(frames)), name)
            self.assertEqual(len(found[0]), 4 if weld or name == "glTF" else 6, name)
            for points, f in zip(found, frames):
                corners = [[points[i] for i in t] for t in triangles]
                wanted = [[transform(*frame(f)[i]) for i in face] for face in FACES]
                for ours, theirs in zip(flat(flat(corners)), flat(flat(wanted))):
                    self.assertAlmostEqual(ours, theirs, 5, (name, f))

    def test_all_formats_give_the_same(self):
        self.check(lambda x, y, z: (x, y, z), range(FRAMES), weld=False)

    def test_welding_is_the_same_for_all(self):
        self.check(lambda x, y, z: (x, y, z), range(FRAMES))

    def test_axis_scale_and_frames_are_the_same_for_all(self):
        self.check(lambda x, y, z: (3 * x, 3 * z, -3 * y), range(1, 6, 2),
                   "--up", "z", "--scale", 3, "--frames", "1:6:2")

    def test_a_rate_is_the_same_for_what_has_times(self):
        del self.inputs["OBJ"], self.inputs["OFF"], self.inputs["PLY"], self.inputs["PC2"], self.inputs["MDD"]
        self.check(lambda x, y, z: (x, y, z), [f / 2 for f in range(2 * FRAMES - 1)], "--fps", 2 * RATE)

    def test_a_clip_or_an_object_is_chosen_where_there_are_such(self):
        for name, option in (("glTF", "--clip"), ("Alembic", "--object")):
            self.assertEqual(len(self.convert(name, option, "walk")[1]), FRAMES)
            self.refuses(1, "run", "info", *self.inputs[name], option, "run", cwd=self.folder)
        for name in ("OBJ", "PC2", "Alembic"):
            self.refuses(1, "clip 'walk' of what is not", "info", *self.inputs[name], "--clip", "walk", cwd=self.folder)
        for name in ("OBJ", "PC2", "glTF"):
            self.refuses(1, "object 'walk' of what is not", "info", *self.inputs[name], "--object", "walk",
                         cwd=self.folder)

    def test_info_names_every_format(self):
        for name in self.inputs:
            told = self.json("info", *self.inputs[name], cwd=self.folder)
            self.assertEqual(told["frames"], FRAMES)
            self.assertIn(name, (told["format"], told["cache_format"]))


if __name__ == "__main__":
    main()
