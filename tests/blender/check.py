# SPDX-License-Identifier: MIT
"""Reads what make.py had Blender write, through `sphmesh convert`, and compares it with what Blender evaluates:

    python3 check.py PROGRAM FOLDER

Vertices may come in another order, and as glTF has them more than once where they were split: each must follow one of
Blender's through all frames, each of Blender's must be followed, and the triangles must be Blender's faces, facing the
same way. Differences above 1e-5 of the bounding diagonal fail.
"""
import glob
import json
import math
import os
import struct
import subprocess
import sys

PROGRAM, FOLDER = sys.argv[1:]
LIMIT = 1e-5


def read_back(arguments):
    """Frames and triangles of an input, as the program writes them."""
    out = os.path.join(FOLDER, "back.obj")
    subprocess.run([PROGRAM, "convert", "--quiet", *arguments, "-o", out], check=True)
    with open(out) as file:
        triangles = [[int(i) - 1 for i in line.split()[1:]] for line in file if line.startswith("f ")]
    with open(out[:-3] + "pc2", "rb") as file:
        data = file.read()
    points, _, _, count = struct.unpack("<iffi", data[16:32])
    values = struct.unpack(f"<{3 * points * count}f", data[32:])
    vertices = [values[i:i + 3] for i in range(0, len(values), 3)]
    return [vertices[f * points:(f + 1) * points] for f in range(count)], triangles


def fan(face):
    return [(face[0], face[i], face[i + 1]) for i in range(1, len(face) - 1)]


def area_vectors(triangles, points, faces_of):
    """The area, as a vector, of each face: it does not depend on how the face is cut into triangles."""
    sums = {}
    for triangle in triangles:
        a, b, c = (points[i] for i in triangle)
        u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
        cross = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        face = faces_of(triangle)
        sums[face] = [x + y / 2 for x, y in zip(sums.get(face, (0, 0, 0)), cross)]
    return sums


def check(name, arguments, truth):
    frames, triangles = read_back(arguments)
    wanted = [[(x, z, -y) for x, y, z in frame] for frame in truth["frames"]]  # y up
    diagonal = math.dist(*([side(p[k] for frame in wanted for p in frame) for k in range(3)] for side in (min, max)))
    if len(frames) != len(wanted):
        return print(f"FAILED  {name}: {len(frames)} frames, Blender has {len(wanted)}") or False
    followed, worst = [], 0
    for v in range(len(frames[0])):
        distances = [max(math.dist(frames[f][v], wanted[f][w]) for f in range(len(wanted)))
                     for w in range(len(wanted[0]))]
        followed.append(distances.index(min(distances)))
        worst = max(worst, min(distances) / diagonal)
    corners = {i: {n for n, face in enumerate(truth["faces"]) if i in face} for i in range(len(wanted[0]))}

    def face_of(triangle):
        shared = set.intersection(*(corners[followed[i]] for i in triangle))
        return shared.pop() if len(shared) == 1 else None
    ours = area_vectors(triangles, frames[0], face_of)
    theirs = area_vectors([t for face in truth["faces"] for t in fan(face)], wanted[0],
                          lambda t: set.intersection(*(corners[i] for i in t)).pop())
    allowed = LIMIT * diagonal ** 2
    good_faces = ours.keys() == theirs.keys() and all(math.dist(ours[n], theirs[n]) < allowed for n in ours)
    good = worst <= LIMIT and set(followed) == set(range(len(wanted[0]))) and good_faces
    print(f"{'ok' if good else 'FAILED'}  {name}: {len(frames)} frames of {len(frames[0])} vertices, {len(triangles)} "
          f"triangles{'' if good_faces else ' that are others'}; at most {worst:.1e} of the diagonal apart")
    return good


def main():
    with open(os.path.join(FOLDER, "truth.json")) as file:
        truth = json.load(file)
    fps = str(truth["fps"])

    def inside(name):
        return os.path.join(FOLDER, name)
    first = {up: inside(f"obj_{up}_0.obj") for up in "yz"}
    inputs = {
        "OBJ sequence, y up": [inside("obj_y_%d.obj")],
        "OBJ sequence, z up": [inside("obj_z_*.obj"), "--up", "z"],
        "PC2, y up": [first["y"], "--cache", inside("y.pc2")],
        "PC2, z up": [first["z"], "--cache", inside("z.pc2"), "--up", "z"],
        "MDD, z up": [first["z"], "--cache", inside("z.mdd"), "--up", "z"],
        "PLY sequence (text), y up": [inside("ply_y_%d.ply")],
        "PLY sequence (binary), z up, in centimetres": [inside("ply_z_%d.ply"), "--up", "z", "--scale", "0.01"],
        "STL sequence, z up": [inside("stl_z_%d.stl"), "--up", "z"],
        "GLB, skin": [inside("skin.glb"), "--fps", fps],
        "GLB, morph targets": [inside("morph.glb"), "--fps", fps, "--clip", "KeyAction"],
    }
    if glob.glob(inside("*.abc")):
        inputs["Alembic"] = [inside("finger.abc"), "--space", "world"]
    print(f"Blender {truth['version']}, {len(truth['frames'])} frames")
    results = [check(name, arguments, truth) for name, arguments in inputs.items()]
    if "Alembic" not in inputs:
        print("left out  Alembic: this Blender is built without it")
    sys.exit(0 if all(results) else 1)


main()
