#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Tables and a plot of what bench_simplify measured.

usage: simplify_report.py TABLE.csv [RIG PLOT.svg]       TABLE.csv of `bench_simplify --csv`; the plot is of one rig"""
import csv
import math
import sys

METHODS = {"ours": "this library", "mohr-gleicher": "Mohr and Gleicher", "decoro-rusinkiewicz": "DeCoro and Rusinkiewicz",
           "static": "rest pose alone"}
COLOURS = {"ours": "#c0392b", "mohr-gleicher": "#2471a3", "decoro-rusinkiewicz": "#7d6608", "static": "#616a6b"}
FIELDS = ("rig", "method", "percent", "vertices", "triangles", "mean", "most", "mean_other", "most_other", "seconds")


def read(path):
    with open(path, encoding="utf-8", newline="") as file:
        return [dict(zip(FIELDS, row)) for row in csv.reader(file)]


def table(rows, keys, digits):
    print("| rig | vertices | " + " | ".join(METHODS.values()) + " |\n|---|---|" + "---|" * len(METHODS))
    for rig in dict.fromkeys(row["rig"] for row in rows):
        for percent in dict.fromkeys(row["percent"] for row in rows if row["rig"] == rig):
            cells = {row["method"]: [float(row[key]) for key in keys] for row in rows
                     if (row["rig"], row["percent"]) == (rig, percent)}
            least = [min(cell[i] for cell in cells.values()) for i in range(len(keys))]
            shown = [" / ".join(f"**{x:.{digits}f}**" if x == least[i] else f"{x:.{digits}f}" for i, x in enumerate(cells[m]))
                     for m in METHODS]
            print(f"| {rig.removesuffix('.glb')} | {percent} % | " + " | ".join(shown) + " |")
    print()


def plot(rows, path):
    """Mean distance by vertices, both on a logarithmic scale: lines over example poses, dots over the others."""
    width, height, left, right, top, bottom = 640, 400, 60, 190, 20, 50
    xs = [math.log(float(row["percent"])) for row in rows]
    ys = [math.log(float(row[key])) for row in rows for key in ("mean", "mean_other")]

    def place(percent, mean):
        x = left + (math.log(percent) - min(xs)) / (max(xs) - min(xs)) * (width - left - right)
        y = top + (max(ys) - math.log(mean)) / (max(ys) - min(ys)) * (height - top - bottom)
        return x, y

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">',
           f'<rect width="{width}" height="{height}" fill="white"/>']
    for percent in sorted({float(row["percent"]) for row in rows}):
        x, _ = place(percent, math.exp(min(ys)))
        out.append(f'<path d="M{x:.1f} {top}V{height - bottom}" stroke="#ddd"/>'
                   f'<text x="{x:.1f}" y="{height - bottom + 18}" text-anchor="middle">{percent:g} %</text>')
    for tick in (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1):
        if min(ys) <= math.log(tick) <= max(ys):
            _, y = place(math.exp(min(xs)), tick)
            out.append(f'<path d="M{left} {y:.1f}H{width - right}" stroke="#ddd"/>'
                       f'<text x="{left - 6}" y="{y + 4:.1f}" text-anchor="end">{tick:g}</text>')
    for i, (method, name) in enumerate(METHODS.items()):
        own = sorted((row for row in rows if row["method"] == method), key=lambda row: float(row["percent"]))
        line = " ".join("{:.1f},{:.1f}".format(*place(float(row["percent"]), float(row["mean"]))) for row in own)
        out.append(f'<polyline points="{line}" fill="none" stroke="{COLOURS[method]}" stroke-width="2"/>')
        for row in own:
            x, y = place(float(row["percent"]), float(row["mean_other"]))
            out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{COLOURS[method]}"/>')
        y = top + 20 + 20 * i
        out.append(f'<path d="M{width - right + 14} {y - 4}h22" stroke="{COLOURS[method]}" stroke-width="2"/>'
                   f'<text x="{width - right + 42}" y="{y}">{name}</text>')
    out += [f'<text x="{(left + width - right) / 2}" y="{height - 10}" text-anchor="middle">vertices left</text>',
            f'<text transform="translate(16 {(top + height - bottom) / 2}) rotate(-90)" text-anchor="middle">'
            "mean distance, % of the diagonal</text>", "</svg>"]
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(out) + "\n")


def main():
    rows = read(sys.argv[1])
    if len(sys.argv) > 3:
        plot([row for row in rows if row["rig"].removesuffix(".glb") == sys.argv[2]], sys.argv[3])
    print("Mean distance:\n")
    table(rows, ("mean", "mean_other"), 4)
    print("Largest distance:\n")
    table(rows, ("most", "most_other"), 2)


main()
