#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""--memory-limit: an animation larger than the limit gives the same file, and what can go wrong with the temporary file."""
import array
import hashlib
import math
import os
import resource
import shutil
import struct
import subprocess
import tempfile

from support import PROGRAM, Case, main

RINGS, SIDES, POSES, FRAMES = 60, 40, 24, 1680
MEBIBYTE = 1 << 20
LIMIT = 20 * MEBIBYTE
# What may come on top of that and of the program itself, on a machine that keeps the watching thread waiting.
MARGIN = 64 * MEBIBYTE


def pose(number):
    """A torus that bends, as the bytes of one frame."""
    values = array.array("f")
    phase = 2 * math.pi * number / POSES
    for ring in range(RINGS):
        a = 2 * math.pi * ring / RINGS
        for side in range(SIDES):
            b = 2 * math.pi * side / SIDES
            r = 0.3 + 0.08 * math.sin(3 * a + phase) + 0.03 * math.sin(5 * b + 7 * a)
            values.extend(((1 + r * math.cos(b)) * math.cos(a), (1 + r * math.cos(b)) * math.sin(a),
                           r * math.sin(b) + 0.3 * math.sin(2 * a + phase)))
    return values.tobytes()


def write_input(folder):
    poses = [pose(number) for number in range(POSES)]
    with open(os.path.join(folder, "torus.pc2"), "wb") as file:
        file.write(b"POINTCACHE2\0" + struct.pack("<iiffi", 1, RINGS * SIDES, 0, 1, FRAMES))
        for frame in range(FRAMES):
            file.write(poses[frame % POSES])
    with open(os.path.join(folder, "torus.obj"), "w", encoding="ascii") as file:
        for x, y, z in struct.iter_unpack("<fff", poses[0]):
            file.write(f"v {x:.9g} {y:.9g} {z:.9g}\n")
        for ring in range(RINGS):
            for side in range(SIDES):
                here, up = ring * SIDES, (side + 1) % SIDES
                there = (ring + 1) % RINGS * SIDES
                file.write(f"f {here + side + 1} {there + side + 1} {there + up + 1} {here + up + 1}\n")


def setUpModule():
    global FOLDER, INPUT, SIZE
    FOLDER = tempfile.mkdtemp(dir="/var/tmp")  # not in memory, as /tmp may be
    write_input(FOLDER)
    INPUT = ["build", os.path.join(FOLDER, "torus.obj"), "--cache", os.path.join(FOLDER, "torus.pc2")]
    SIZE = 12 * RINGS * SIDES * FRAMES


def tearDownModule():
    shutil.rmtree(FOLDER)


def digest(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


class Limit(Case):
    def test_an_animation_larger_than_the_limit_gives_the_same_file_and_stays_near_the_limit(self):
        self.assertGreater(SIZE, 2 * LIMIT)
        spill = os.path.join(FOLDER, "spill")
        os.mkdir(spill)
        whole, limited = os.path.join(FOLDER, "whole.sphm"), os.path.join(FOLDER, "limited.sphm")
        own = self.json(*INPUT, "--frames", "0:1:1", "-o", whole)  # what a sanitizer adds, for the most part
        free = self.json(*INPUT, "-o", whole)
        held = self.json(*INPUT, "-o", limited, "--memory-limit", f"{LIMIT // MEBIBYTE}M", "--temporary-folder", spill)
        self.assertEqual(digest(whole), digest(limited))
        self.assertEqual(os.listdir(spill), [])
        self.assertLess(held["peak_rss_bytes"], own["peak_rss_bytes"] + LIMIT + MARGIN)
        self.assertLess(held["peak_rss_bytes"], free["peak_rss_bytes"] / 2)

    def test_a_small_animation_under_a_large_limit_is_the_same_file_too(self):
        free, held = os.path.join(FOLDER, "free.sphm"), os.path.join(FOLDER, "held.sphm")
        few = ["--frames", "0:3"]
        self.succeeds(*INPUT, *few, "-o", free)
        self.succeeds(*INPUT, *few, "-o", held, "--memory-limit", "1.5GiB", "--threads", 2)
        self.assertEqual(digest(free), digest(held))


class Trouble(Case):
    OUTPUT = "/var/tmp/never-made.sphm"

    def limited(self, *options):
        return [*INPUT, "-o", self.OUTPUT, "--memory-limit", "32M", *options]

    def tearDown(self):
        self.assertFalse(os.path.exists(self.OUTPUT))

    def test_a_folder_that_is_not_there_is_named(self):
        self.refuses(1, "/nowhere/at/all", *self.limited("--temporary-folder", "/nowhere/at/all"))

    def test_a_file_is_no_folder(self):
        path = os.path.join(FOLDER, "torus.obj")
        done = self.refuses(1, path, *self.limited("--temporary-folder", path))
        self.assertIn("Not a directory", done.stderr)

    def test_a_folder_that_cannot_be_written_to_is_named(self):
        if os.geteuid() == 0:
            self.skipTest("root may write anywhere")
        path = os.path.join(FOLDER, "closed")
        os.mkdir(path, 0o500)
        self.refuses(1, path, *self.limited("--temporary-folder", path))

    def test_the_folder_comes_from_the_environment(self):
        done = subprocess.run([PROGRAM, *map(str, self.limited())], capture_output=True, text=True, timeout=600,
                              env={**os.environ, "TMPDIR": "/nowhere/else"})
        self.assertEqual(done.returncode, 1)
        self.assertIn("/nowhere/else", done.stderr)

    def test_a_file_that_may_not_grow_is_an_error_that_says_so(self):
        def hold():
            resource.setrlimit(resource.RLIMIT_FSIZE, (40 * MEBIBYTE, 40 * MEBIBYTE))
        # Python ignores SIGXFSZ; restore_signals=False hands that on, so that the call fails instead.
        done = subprocess.run([PROGRAM, *map(str, self.limited("--temporary-folder", FOLDER))], capture_output=True,
                              text=True, timeout=600, preexec_fn=hold, restore_signals=False)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn(FOLDER, done.stderr)
        self.assertIn("cannot grow", done.stderr)
        self.assertIn("File too large", done.stderr)

    def test_a_full_disk_is_an_error_that_says_so(self):
        small = os.path.join(FOLDER, "small")
        os.makedirs(small, exist_ok=True)
        mount = ["unshare", "--map-root-user", "--mount", "sh", "-c",
                 'mount -t tmpfs -o size=40M small "$0" && exec "$@"', small]
        if shutil.which("unshare") is None or subprocess.run([*mount, "true"], capture_output=True).returncode != 0:
            self.skipTest("no small file system can be mounted here")
        done = subprocess.run([*mount, PROGRAM, *map(str, self.limited("--temporary-folder", small))],
                              capture_output=True, text=True, timeout=600)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn(small, done.stderr)
        self.assertIn("No space left on device", done.stderr)
        self.assertIn("kept in memory", done.stderr)


class Usage(Case):
    def test_sizes_that_are_none_are_refused(self):
        for size in ("0", "1M", "15.9M", "-64M", "64X", "M", "64MM", "nan", "1e30", "64 M", ""):
            self.refuses(2, "--memory-limit", *INPUT, "-o", "x.sphm", "--memory-limit", size)

    def test_a_folder_without_a_limit_is_refused(self):
        self.refuses(2, "--temporary-folder", *INPUT, "-o", "x.sphm", "--temporary-folder", FOLDER)


if __name__ == "__main__":
    main()
