# SPDX-License-Identifier: MIT
"""A finger of three bones that bends, out of Blender in every format that it writes:

    blender -b --factory-startup -P make.py -- FOLDER

FOLDER/truth.json has the faces and, for each frame, the vertices as Blender evaluates them, without any exporter.
"""
import json
import math
import os
import sys

import addon_utils
import bpy
import numpy
from mathutils import Matrix, Vector

numpy.bool = bool  # the exporter of glTF of Blender 3.4 asks for it; newer numpy has lost it
FOLDER = sys.argv[sys.argv.index("--") + 1]
FPS, FRAMES, SIDES, RINGS, BONES = 24, 12, 7, 10, 3


def path(name):
    return os.path.join(FOLDER, name)


def make_shape():
    """A closed tube along z, with caps of 7 corners, which is nowhere symmetric."""
    vertices, faces = [], []
    for ring in range(RINGS):
        for side in range(SIDES):
            angle, radius = 2 * math.pi * side / SIDES, 0.3 + 0.03 * math.sin(3 * ring + side)
            vertices.append((radius * math.cos(angle), 0.7 * radius * math.sin(angle), 3 * ring / (RINGS - 1)))
    for ring in range(RINGS - 1):
        for side in range(SIDES):
            a, b = ring * SIDES + side, ring * SIDES + (side + 1) % SIDES
            faces.append((a, b, b + SIDES, a + SIDES))
    faces.append(tuple(reversed(range(SIDES))))
    faces.append(tuple(range((RINGS - 1) * SIDES, RINGS * SIDES)))
    return vertices, faces


def make_object(name, vertices, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    for polygon in mesh.polygons:
        polygon.use_smooth = True  # else vertices are split along every edge
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(thing)
    return thing


def make_skin(vertices, faces):
    """Bones of length 1, one on the other, that bend by angles of their own; every vertex hangs on all three."""
    rig = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for i in range(BONES):
        bone = rig.data.edit_bones.new(f"bone{i}")
        bone.head, bone.tail = (0, 0, i), (0, 0, i + 1)
        if i > 0:
            bone.parent = rig.data.edit_bones[f"bone{i - 1}"]
    bpy.ops.object.mode_set(mode="OBJECT")
    finger = make_object("finger", vertices, faces)
    groups = [finger.vertex_groups.new(name=f"bone{i}") for i in range(BONES)]
    for number, (_, _, z) in enumerate(vertices):
        weights = [math.exp(-0.4 * (z - i - 0.5) ** 2) for i in range(BONES)]  # the exporter drops those below 0.0001
        for group, weight in zip(groups, weights):
            group.add([number], weight / sum(weights), "REPLACE")
    finger.parent = rig
    finger.modifiers.new("rig", "ARMATURE").object = rig
    for i in range(BONES):
        bone = rig.pose.bones[f"bone{i}"]
        bone.rotation_mode = "QUATERNION"
        for frame in range(FRAMES):
            bend, turn = 0.12 * frame * (1 + 0.3 * i), 0.05 * frame * i
            bone.rotation_quaternion = Matrix.Rotation(bend, 3, "X").to_quaternion() @ Matrix.Rotation(
                turn, 3, "Y").to_quaternion()
            bone.keyframe_insert("rotation_quaternion", frame=frame)
            if i == 0:
                bone.location = Vector((0.02 * frame, 0, 0))
                bone.keyframe_insert("location", frame=frame)
    return rig, finger


def evaluate(thing):
    frames = []
    for frame in range(FRAMES):
        bpy.context.scene.frame_set(frame)
        evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
        mesh = evaluated.to_mesh()
        frames.append([tuple(evaluated.matrix_world @ v.co) for v in mesh.vertices])
        evaluated.to_mesh_clear()
    return frames


def make_morph(frames, faces):
    """The same once more, without bones: a shape for each frame, fully on in it and off in all others."""
    morph = make_object("morph", frames[0], faces)
    morph.shape_key_add(name="rest")
    for number in range(1, FRAMES):
        key = morph.shape_key_add(name=f"frame{number}")
        for point, place in zip(key.data, frames[number]):
            point.co = place
        for frame in range(FRAMES):
            key.value = 1 if frame == number else 0
            key.keyframe_insert("value", frame=frame)
    return morph


def select(*things):
    bpy.ops.object.select_all(action="DESELECT")
    for thing in things:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = things[-1]


def export(rig, finger, morph):
    for name in ("io_export_pc2", "io_shape_mdd", "io_scene_gltf2", "io_mesh_ply", "io_mesh_stl"):
        addon_utils.enable(name)
    select(finger)
    for name, forward, up in (("y", "NEGATIVE_Z", "Y"), ("z", "Y", "Z")):
        bpy.ops.wm.obj_export(filepath=path(f"obj_{name}_.obj"), forward_axis=forward, up_axis=up,
                              export_selected_objects=True, export_materials=False, export_animation=True,
                              start_frame=0, end_frame=FRAMES - 1)
    bpy.ops.export_shape.pc2(filepath=path("y.pc2"), rot_x90=True, range_start=0, range_end=FRAMES - 1)
    bpy.ops.export_shape.pc2(filepath=path("z.pc2"), rot_x90=False, range_start=0, range_end=FRAMES - 1)
    bpy.ops.export_shape.mdd(filepath=path("z.mdd"), frame_start=0, frame_end=FRAMES - 1, fps=FPS)
    for frame in range(FRAMES):
        bpy.context.scene.frame_set(frame)
        common = {"use_selection": True}
        bpy.ops.export_mesh.ply(filepath=path(f"ply_y_{frame}.ply"), use_normals=False, axis_forward="-Z", axis_up="Y",
                                use_ascii=True, **common)
        bpy.ops.export_mesh.ply(filepath=path(f"ply_z_{frame}.ply"), use_normals=False, axis_forward="Y", axis_up="Z",
                                global_scale=100, **common)
        bpy.ops.export_mesh.stl(filepath=path(f"stl_z_{frame}.stl"), axis_forward="Y", axis_up="Z", **common)
    gltf = {"export_format": "GLB", "use_selection": True, "export_animations": True, "export_force_sampling": True}
    select(rig, finger)
    bpy.ops.export_scene.gltf(filepath=path("skin.glb"), **gltf)
    select(morph)
    bpy.ops.export_scene.gltf(filepath=path("morph.glb"), **gltf)
    if bpy.app.build_options.alembic:
        select(finger)
        bpy.ops.wm.alembic_export(filepath=path("finger.abc"), start=0, end=FRAMES - 1, selected=True, flatten=True)


bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps, scene.frame_start, scene.frame_end = FPS, 0, FRAMES - 1
shape = make_shape()
armature, skinned = make_skin(*shape)
truth = evaluate(skinned)
with open(path("truth.json"), "w") as out:
    json.dump({"fps": FPS, "faces": shape[1], "frames": truth, "version": bpy.app.version_string}, out)
export(armature, skinned, make_morph(truth, shape[1]))
