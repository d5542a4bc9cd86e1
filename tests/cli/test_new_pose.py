#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""examples/new_pose.c on the creature: what was moved is where it was put, the rest stays.

usage: test_new_pose.py PROGRAM EXAMPLE"""
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile

from support import Case, main

EXAMPLE = os.path.abspath(sys.argv[2])


def example(*arguments):
    return subprocess.run([EXAMPLE, *arguments], cwd=FOLDER, capture_output=True, text=True, timeout=600)


def setUpModule():
    global FOLDER, FIRST
    FOLDER = tempfile.mkdtemp()
    case = Case()
    case.succeeds("demo", "-o", FOLDER, "--frame-count", 8, "--resolution", 32, "--samples", 10, "--quiet")
    case.succeeds("level", "creature.sphm", "--spheres", 40, "-o", "before.json", "--quiet", cwd=FOLDER)
    FIRST = example("creature.obj", "creature.pc2", "after.obj", "after.json")


def tearDownModule():
    shutil.rmtree(FOLDER)


def level(name):
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        parts = json.load(file)
    return parts["centers"][0], parts["radii"]


def mesh(name):
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        rows = [line.split() for line in file]
    return [[tuple(map(float, row[1:])) for row in rows if row and row[0] == kind] for kind in ("v", "vn")]


class NewPose(Case):
    def setUp(self):
        self.assertEqual(FIRST.returncode, 0, FIRST.stderr)
        self.before, self.after = level("before.json")[0], level("after.json")[0]
        self.moved = [i for i, (a, b) in enumerate(zip(self.before, self.after)) if math.dist(a, b) > 1e-6]

    def test_a_few_spheres_are_moved_and_none_changes_its_size(self):
        self.assertEqual(level("before.json")[1], level("after.json")[1])
        self.assertGreater(len(self.moved), 4)
        self.assertLess(len(self.moved), 20)

    def test_the_paw_is_lifted_with_its_sphere(self):
        paw = max((i for i in self.moved if self.before[i][1] < 0.3), key=lambda i: self.before[i][0])
        self.assertGreater(self.after[paw][1] - self.before[paw][1], 0.15)
        near = [b[1] - a[1] for a, b in zip(mesh("creature.obj")[0], mesh("after.obj")[0])
                if math.dist(a, self.before[paw]) < 0.1]
        self.assertGreater(len(near), 3)
        self.assertGreater(min(near), 0.1)

    def test_what_is_far_from_moved_spheres_stays(self):
        diagonal = 4.0  # of the creature, about
        far = [math.dist(a, b) for a, b in zip(mesh("creature.obj")[0], mesh("after.obj")[0]) if a[0] < -0.9]
        self.assertGreater(len(far), 100)
        self.assertLess(max(far), 0.01 * diagonal)  # the rest pose is not the first frame to the last digit

    def test_the_mesh_is_whole_and_has_normals(self):
        info = self.json("info", "after.obj", cwd=FOLDER)
        before = self.json("info", "creature.obj", cwd=FOLDER)
        self.assertEqual((info["vertices"], info["triangles"]), (before["vertices"], before["triangles"]))
        vertices, normals = mesh("after.obj")
        self.assertTrue(all(math.isfinite(x) for v in vertices for x in v))
        self.assertTrue(all(abs(math.hypot(*n) - 1) < 1e-5 for n in normals))

    def test_what_is_wrong_is_said(self):
        self.assertEqual(example().returncode, 2)
        done = example("creature.obj", "missing.pc2", "x.obj", "x.json")
        self.assertEqual(done.returncode, 1)
        self.assertIn("missing.pc2", done.stderr)


if __name__ == "__main__":
    main()
