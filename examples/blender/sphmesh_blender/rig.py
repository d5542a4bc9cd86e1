# SPDX-License-Identifier: MIT
"""Skins as armatures: a bone for each sphere, keys for every frame, and a mesh that follows by weights."""
import bpy
import numpy as np

from .animate import action_of, add_curves


def square(transforms):
    """(..., 3, 4) as (..., 4, 4)"""
    last = np.broadcast_to([0.0, 0, 0, 1], (*transforms.shape[:-2], 1, 4))
    return np.concatenate([transforms, last], axis=-2)


def quaternions(rotations):
    """Rotations (F, 3, 3) as quaternions w x y z (F, 4) that do not jump from frame to frame."""
    m = rotations
    trace = np.trace(m, axis1=1, axis2=2)
    # Four ways to find it, each good where its own square is the largest.
    squares = np.stack([trace, *(2 * m[:, i, i] - trace for i in range(3))], 1) + 1
    skew = np.stack([m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1]], 1)
    sums = m + np.swapaxes(m, 1, 2)
    ways = np.empty((len(m), 4, 4))
    ways[:, 0] = np.c_[squares[:, 0], skew]
    for i in range(3):
        ways[:, i + 1, 0], ways[:, i + 1, 1:] = skew[:, i], sums[:, i]
        ways[:, i + 1, i + 1] = squares[:, i + 1]
    q = ways[np.arange(len(m)), squares.argmax(axis=1)]
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    turns = np.cumprod(np.where((q[1:] * q[:-1]).sum(axis=1) < 0, -1, 1))
    q[1:] *= turns[:, None]
    return q


def tails(skin, skeleton, size):
    """Where bones end: at the mean of their children's joints, or beyond the sphere's centre."""
    heads, parents = np.array(skeleton.positions), skeleton.parents
    ends = np.empty_like(heads)
    for bone, head in enumerate(heads):
        children = np.flatnonzero(parents == bone)
        way = (heads[children].mean(axis=0) if len(children) else 2 * skin.pivots[bone] - head) - head
        length = np.linalg.norm(way)
        least = 0.01 * size
        ends[bone] = head + (way if length > least else [0, 0, max(least, skin.radii[bone])])
    return ends


def make_armature(context, collection, skin, skeleton, size, name):
    """The armature at rest; rest matrices of its bones, (J, 4, 4)."""
    thing = bpy.data.objects.new(name, bpy.data.armatures.new(name))
    collection.objects.link(thing)
    before = context.view_layer.objects.active
    context.view_layer.objects.active = thing
    bpy.ops.object.mode_set(mode="EDIT")
    ends = tails(skin, skeleton, size)
    bones = []
    for i, (head, tail) in enumerate(zip(skeleton.positions, ends)):
        bone = thing.data.edit_bones.new(f"bone {i:03d}")
        bone.head, bone.tail = head, tail
        bones.append(bone)
    for bone, parent in zip(bones, skeleton.parents):
        if parent < len(bones):
            bone.parent = bones[parent]
    bpy.ops.object.mode_set(mode="OBJECT")
    context.view_layer.objects.active = before
    names = [f"bone {i:03d}" for i in range(len(ends))]
    return thing, names, np.array([thing.data.bones[n].matrix_local for n in names], float)


def add_poses(thing, names, rest, skin, skeleton, frames):
    """Keys that give every bone the transform that the skin has for it, relative to its parent."""
    posed = square(np.asarray(skin.transforms)) @ rest  # (F, J, 4, 4), in the armature's space
    action = action_of(thing, thing.name)
    for i, name in enumerate(names):
        parent = int(skeleton.parents[i])
        local = np.linalg.inv(rest[i]) @ posed[:, i]
        if parent < len(names):
            local = np.linalg.inv(rest[i]) @ rest[parent] @ np.linalg.inv(posed[:, parent]) @ posed[:, i]
        thing.pose.bones[name].rotation_mode = "QUATERNION"
        path = f'pose.bones["{name}"].'
        add_curves(action, path + "location", frames, local[:, :3, 3], name)
        add_curves(action, path + "rotation_quaternion", frames, quaternions(local[:, :3, :3]), name)


def make_mesh(context, collection, capture, skin, armature, names, name):
    """The object's own mesh, faces, materials and all, in the rest pose, with weights."""
    context.scene.frame_set(capture.frames[0])
    graph = context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(capture.thing.evaluated_get(graph), depsgraph=graph)
    mesh.name = name
    mesh.vertices.foreach_set("co", np.ascontiguousarray(skin.rest).ravel())
    if capture.mirrored:
        mesh.flip_normals()
    mesh.update()
    thing = bpy.data.objects.new(name, mesh)
    collection.objects.link(thing)
    thing.vertex_groups.clear()
    groups = [thing.vertex_groups.new(name=n) for n in names]
    for slot in range(skin.influence_count):
        for vertex, (bone, weight) in enumerate(zip(skin.bones[:, slot].tolist(), skin.weights[:, slot].tolist())):
            if weight > 0:
                groups[bone].add((vertex,), weight, "REPLACE")
    thing.parent = armature
    thing.modifiers.new("Armature", "ARMATURE").object = armature
    return thing


def make_rig(context, collection, capture, skin, skeleton, name):
    """Armature and mesh."""
    size = float(np.linalg.norm(np.ptp(capture.positions[0], axis=0)))
    armature, names, rest = make_armature(context, collection, skin, skeleton, size, f"{name} rig")
    add_poses(armature, names, rest, skin, skeleton, np.array(capture.frames, float))
    armature.show_in_front = True
    return armature, make_mesh(context, collection, capture, skin, armature, names, f"{name} skinned")
