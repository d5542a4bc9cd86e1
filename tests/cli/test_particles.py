#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""examples/particles.c on the creature: what the sphere-mesh keeps out, and the simplified mesh does not.

usage: test_particles.py PROGRAM EXAMPLE"""
import os
import re
import shutil
import subprocess
import sys
import tempfile

from support import Case, main

EXAMPLE = os.path.abspath(sys.argv[2])
SPHERES = 16


def particles(*arguments):
    return subprocess.run([EXAMPLE, *arguments], cwd=FOLDER, capture_output=True, text=True, timeout=600)


def setUpModule():
    global FOLDER, FIRST
    FOLDER = tempfile.mkdtemp()
    case = Case()
    case.succeeds("demo", "-o", FOLDER, "--frame-count", 24, "--resolution", 32, "--samples", 10, "--quiet")
    for name in ("creature", "creature-qem"):
        case.succeeds("level", f"{name}.sphm", "--spheres", SPHERES, "-o", f"{name}.json", "--quiet", cwd=FOLDER)
    FIRST = particles("creature.json", "creature-qem.json", "creature.obj", "creature.pc2", "strip.png")


def tearDownModule():
    shutil.rmtree(FOLDER)


def table():
    """collider: (vertices, bounces, leaks, roughness, tilt)"""
    rows = re.findall(r"(?m)^(\S+) +(\d+) +(\d+) +(\d+) +([\d.]+) +([\d.]+)$", FIRST.stdout)
    return {name: tuple(map(float, values)) for name, *values in rows}


class Particles(Case):
    def test_it_runs_and_tells_of_three_colliders(self):
        self.assertEqual(FIRST.returncode, 0, FIRST.stderr)
        self.assertEqual(list(table()), ["sphere-mesh", "QEM", "input"])
        self.assertEqual([table()[name][0] for name in ("sphere-mesh", "QEM")], [SPHERES, SPHERES])

    def test_nothing_gets_through_the_input_itself(self):
        self.assertEqual(table()["input"][2], 0)
        self.assertGreater(table()["input"][1], 100)

    def test_the_sphere_mesh_keeps_out_what_the_simplified_mesh_lets_in(self):
        self.assertEqual(table()["sphere-mesh"][2], 0)
        self.assertGreater(table()["QEM"][2], 5)
        self.assertGreater(table()["sphere-mesh"][1], 100)

    def test_the_sphere_mesh_has_the_smoother_and_the_truer_normals(self):
        self.assertLess(table()["sphere-mesh"][3], table()["QEM"][3])
        self.assertLess(table()["sphere-mesh"][4], 0.6 * table()["QEM"][4])

    def test_the_strip_is_a_picture_of_three_by_three_tiles(self):
        with open(os.path.join(FOLDER, "strip.png"), "rb") as file:
            picture = file.read()
        self.assertEqual(picture[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual([int.from_bytes(picture[i:i + 4], "big") % 3 for i in (16, 20)], [0, 0])
        self.assertGreater(len(picture), 10000)

    def test_what_is_wrong_is_said(self):
        self.assertEqual(particles().returncode, 2)
        done = particles("missing.json", "creature-qem.json", "creature.obj", "creature.pc2")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("missing.json", done.stderr)
        self.succeeds("build", "creature.obj", "-o", "one.sphm", "--quiet", cwd=FOLDER)
        self.succeeds("level", "one.sphm", "--spheres", 9, "-o", "one.json", "--quiet", cwd=FOLDER)
        done = particles("one.json", "creature-qem.json", "creature.obj", "creature.pc2")
        self.assertEqual(done.returncode, 1)
        self.assertIn("number of frames", done.stderr)


if __name__ == "__main__":
    main()
