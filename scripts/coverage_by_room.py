#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Sums a summary of gcovr by room: lines, those that the tests reach, and the files that are reached least.

    coverage_by_room.py SUMMARY.json
"""
import json
import sys
from collections import defaultdict
from pathlib import PurePath


def main():
    rooms = defaultdict(list)
    for entry in json.load(open(sys.argv[1], encoding="utf-8"))["files"]:
        path = PurePath(entry["filename"])
        room = "/".join(path.parts[:2]) if path.parts[0] == "lib" else path.parts[0]
        rooms[room].append((entry["line_covered"], entry["line_total"], path.name))
    print(f"{'room':16} {'lines':>7} {'reached':>8}   least reached")
    total = [0, 0]
    for room, files in sorted(rooms.items()):
        covered, lines = sum(f[0] for f in files), sum(f[1] for f in files)
        total[0] += covered
        total[1] += lines
        least = sorted(files, key=lambda f: f[0] / max(f[1], 1))[:2]
        worst = ", ".join(f"{name} {100 * c / max(n, 1):.0f} %" for c, n, name in least)
        print(f"{room:16} {lines:7} {100 * covered / max(lines, 1):6.1f} %   {worst}")
    print(f"{'all':16} {total[1]:7} {100 * total[0] / max(total[1], 1):6.1f} %")


if __name__ == "__main__":
    sys.exit(None if len(sys.argv) == 2 and main() is None else __doc__)
