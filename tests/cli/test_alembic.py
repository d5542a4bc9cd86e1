#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""An Alembic archive through the program: told by info, converted, built; the archive is test_io_alembic.c's scene."""
import os
import struct
import tempfile

from support import Case, main

FIXTURES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "io", "fixtures")
SCENE = os.path.join(FIXTURES, "alembic_scene.abc")


class Alembic(Case):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def first_point(self, *options):
        self.succeeds("convert", SCENE, "--object", "cage", "-o", self.path("a.obj"), *options)
        with open(self.path("a.obj")) as file:
            points = [tuple(map(float, line.split()[1:])) for line in file if line.startswith("v ")]
        return points[2]

    def test_info_tells_who_wrote_it_what_it_holds_and_what_is_chosen(self):
        told = self.succeeds("info", SCENE).stdout
        for line in ("library 1.8.0, written by make_alembic.py on today", "* /root/body, PolyMesh",
                     "* /root/cage, SubD", "  /root/hair, Curve", "  /root/ghost/ghostShape, PolyMesh, hidden"):
            self.assertIn(line, told)
        told = self.json("info", SCENE, "--object", "/root/body")
        self.assertEqual((told["archive"]["version"], told["archive"]["application"]), (10800, "make_alembic.py"))
        self.assertEqual([o["path"] for o in told["objects"] if o["chosen"]], ["/root/body"])
        self.assertEqual((told["vertices"], told["triangles"], told["frames"]), (8, 12, 5))
        self.assertEqual([(o["samples"], o["faces"]) for o in told["objects"][:3]], [(1, 0), (5, 6), (1, 1)])

    def test_info_names_the_format_of_any_input(self):
        with open(self.path("a.obj"), "w") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        with open(self.path("a.obj")) as one, open(self.path("b.obj"), "w") as other:
            other.write(one.read())
        self.succeeds("convert", self.path("a.obj"), self.path("b.obj"), "-o", self.path("c.mdd"))
        told = self.json("info", SCENE)
        self.assertEqual((told["format"], told["files"], told["cache_format"]), ("Alembic", 1, None))
        told = self.json("info", self.path("[ab].obj"))
        self.assertEqual((told["format"], told["files"], told["frames"]), ("OBJ", 2, 2))
        told = self.json("info", self.path("c.obj"), "--cache", self.path("c.mdd"))
        self.assertEqual((told["format"], told["cache_format"], told["frames"]), ("OBJ", "MDD", 2))
        told = self.json("info", self.path("c.mdd"))
        self.assertEqual((told["kind"], told["points"], told["frames"]), ("cache", 3, 2))
        self.assertIn("its mesh is another file", self.succeeds("info", self.path("c.mdd")).stdout)

    def test_options_do_what_they_say(self):
        self.assertEqual(self.first_point(), (1, 1, 0))
        self.assertEqual(self.first_point("--up", "z"), (1, 0, -1))
        self.assertEqual(self.first_point("--scale", 2), (2, 2, 0))
        self.assertEqual(tuple(map(round, self.first_point("--space", "world"))), (1, 0, 1))

    def test_frames_are_samples_or_at_a_rate(self):
        def frames(*options):
            return self.json("convert", SCENE, "--object", "copy", "-o", self.path("b.obj"), *options)["frames"]
        self.assertEqual([frames(), frames("--fps", 48), frames("--frames", "1:5:2")], [5, 9, 2])
        self.succeeds("convert", SCENE, "--object", "copy", "-o", self.path("b.mdd"))
        with open(self.path("b.mdd"), "rb") as file:
            self.assertEqual(struct.unpack(">2i", file.read(8)), (5, 8))

    def test_a_hierarchy_is_built_of_it(self):
        told = self.json("build", SCENE, "--object", "body", "--weld", "-o", self.path("c.sphm"))
        self.assertEqual((told["vertices"], told["frames"], told["spheres_min"]), (8, 5, 1))

    def test_what_is_not_read_is_refused(self):
        self.refuses(1, "no mesh 'nobody': it has body, cage, copy", "info", SCENE, "--object", "nobody")
        self.refuses(2, "--space: 'here' is not one of local, world", "info", SCENE, "--space", "here")
        self.refuses(1, "/turns: its topology changes: sample 2 (frame 2, ", "info",
                     os.path.join(FIXTURES, "alembic_topology.abc"))
        with open(self.path("old.abc"), "wb") as file:
            file.write(b"\x89HDF\r\n\x1a\n")
        self.refuses(1, "abcconvert", "info", self.path("old.abc"))


if __name__ == "__main__":
    main()
