# SPDX-License-Identifier: MIT
"""Inside Blender: imports each rig, plays each of its clips, and compares the evaluated vertices with the library's.

    blender -b --factory-startup -P rig_check.py -- RIGS.json

RIGS.json has the lines of tests/gltf/rigs.c. Exit 1 where a vertex is off by more than 1e-5 of the mean diagonal.
"""
import array
import json
import math
import os
import sys

import numpy

numpy.bool = bool  # what Blender's importer still calls it

import bpy  # noqa: E402

LIMIT = 1e-5


def play(mesh, armature, action, frame):
    armature.animation_data.action = action
    bpy.context.scene.frame_set(frame)
    evaluated = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get())
    out = numpy.empty(3 * len(evaluated.data.vertices), dtype=numpy.float32)
    evaluated.data.vertices.foreach_get("co", out)
    world = numpy.array(evaluated.matrix_world)
    points = out.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]
    return numpy.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1)  # y up again


def check(rig):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = rig["fps"]
    bpy.ops.import_scene.gltf(filepath=rig["rig"], merge_vertices=False)
    mesh, = (o for o in bpy.data.objects if o.type == "MESH" and o.find_armature())
    armature = mesh.find_armature()
    for track in list(armature.animation_data.nla_tracks):
        track.mute = True
    truth = array.array("f")
    with open(rig["frames"], "rb") as file:
        truth.frombytes(file.read())
    truth = numpy.array(truth).reshape(-1, rig["vertices"], 3)
    at, worst, diagonals = 0, 0.0, 0.0
    for clip in rig["clips"]:
        action, = (a for a in bpy.data.actions if a.name.startswith(clip["name"]))
        for frame in range(clip["frames"]):
            ours, theirs = truth[at], play(mesh, armature, action, frame)
            if theirs.shape != ours.shape:
                print(f"FAILED  {rig['rig']}: {len(theirs)} vertices, not {len(ours)}")
                return False
            worst = max(worst, float(numpy.linalg.norm(theirs - ours, axis=1).max()))
            diagonals += math.dist(ours.min(axis=0), ours.max(axis=0))
            at += 1
    worst /= diagonals / at
    good = worst <= LIMIT and at == len(truth)
    print(f"{'ok' if good else 'FAILED'}  {os.path.basename(rig['rig'])}: {len(rig['clips'])} clips, {at} frames of "
          f"{rig['vertices']} vertices on {len(armature.data.bones)} bones in Blender {bpy.app.version_string}; "
          f"at most {worst:.2e} of the diagonal apart")
    return good


with open(sys.argv[sys.argv.index("--") + 1]) as lines:
    results = [check(json.loads(line)) for line in lines]
sys.exit(0 if results and all(results) else 1)
