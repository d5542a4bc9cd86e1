# SPDX-License-Identifier: MIT
"""What the commands of the pages work on: a small animation under the names that the pages use."""
import math
import os
import struct
import subprocess

AROUND, ALONG, FRAMES = 12, 44, 48


def point(row, column, frame):
    """A body that swims: thick in front, with a head, thin behind."""
    x, turn = row / ALONG, 2 * math.pi * column / AROUND
    radius = 0.02 + 0.16 * math.sqrt(x) * (1 - 0.6 * math.exp(-200 * (x - 0.8) ** 2))
    if row in (0, ALONG - 1):
        radius = 0.01
    sway = 0.25 * (1.1 - x) * math.sin(6 * x - 2 * math.pi * frame / FRAMES)
    return 3 * x, radius * math.cos(turn), sway + radius * math.sin(turn)


def make_walk(folder):
    quads = [(i, i + AROUND, r * AROUND + (c + 1) % AROUND)
             for r in range(ALONG - 1) for c in range(AROUND) for i in [r * AROUND + c]]
    faces = [f for i, up, right in quads for f in ((i, right, up), (right, right + AROUND, up))]
    ends = [(0, c + 1, c) for c in range(1, AROUND - 1)]
    last = AROUND * (ALONG - 1)
    faces += ends + [(last + a, last + c, last + b) for a, b, c in ends]
    rest = [point(r, c, 0) for r in range(ALONG) for c in range(AROUND)]
    with open(folder / "walk.obj", "w", encoding="ascii") as file:
        file.writelines("v {:.7g} {:.7g} {:.7g}\n".format(*p) for p in rest)
        file.writelines("f {} {} {}\n".format(*(i + 1 for i in f)) for f in faces)
    with open(folder / "walk.pc2", "wb") as file:
        file.write(b"POINTCACHE2\0" + struct.pack("<iiffi", 1, AROUND * ALONG, 0, 1, FRAMES))
        for frame in range(FRAMES):
            for row in range(ALONG):
                for column in range(AROUND):
                    file.write(struct.pack("<3f", *point(row, column, frame)))


def make_fixture(work, program, environment):
    folder = work / "fixture"
    folder.mkdir()
    make_walk(folder)
    (work / "bin").mkdir()
    wrapper = work / "bin/sphmesh"  # the same commands on less: a small creature, small pictures, few samples
    wrapper.write_text(f"""#!/bin/sh
case "$1 $*" in
*--help* | *" --samples "*) ;;
demo*) set -- "$@" --resolution 32 --frame-count 4 --samples 10 ;;
render*) set -- "$@" --size 48 --samples 1 ;;
measure*) set -- "$@" --samples 3000 ;;
esac
exec "{program}" "$@"
""", encoding="utf-8")
    os.chmod(wrapper, 0o755)

    def sphmesh(*arguments):
        subprocess.run([program, *arguments, "--quiet"], cwd=folder, env=environment, check=True)
    walk = ["walk.obj", "--cache", "walk.pc2"]
    sphmesh("build", *walk, "-o", "walk.sphm")
    sphmesh("level", "walk.sphm", "--spheres", "40", "-o", "walk40.json")
    sphmesh("skin", *walk, "--spheres", "8", "--clips", "Survey=0:20,Run=20:48", "-o", "fox.glb")
