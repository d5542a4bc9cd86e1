# SPDX-License-Identifier: MIT
"""Animation data in bulk: curves of many keys, and shape keys for every frame."""
import bpy
import numpy as np

LINEAR = bpy.types.Keyframe.bl_rna.properties["interpolation"].enum_items["LINEAR"].value


def action_of(owner, name):
    """A new action on `owner`, an ID."""
    data = owner.animation_data_create()
    data.action = bpy.data.actions.new(name)
    return data.action


def add_curves(action, path, frames, values, group=""):
    """Linear curves for the components of a property: values of shape (F, components), or (F,) for a plain one."""
    values = np.asarray(values, float)
    components = [(-1, values)] if values.ndim == 1 else list(enumerate(values.T))
    for index, column in components:
        settings = {"index": index} if index >= 0 else {}
        curve = action.fcurves.new(path, action_group=group, **settings)
        same = (column == column[0]).all()
        times, column = (frames[:1], column[:1]) if same else (frames, column)
        curve.keyframe_points.add(len(times))
        curve.keyframe_points.foreach_set("co", np.stack([times, column], 1).ravel())
        curve.keyframe_points.foreach_set("interpolation", np.full(len(times), LINEAR, np.int32))
        curve.update()


def add_shapes(thing, frames, positions):
    """Plays positions of shape (F, n, 3) as absolute shape keys, linear in between."""
    thing.shape_key_add(name="rest")
    keys = thing.data.shape_keys
    keys.use_relative = False
    blocks = [keys.key_blocks[0]] + [thing.shape_key_add(name=f"frame {f:g}") for f in frames[1:]]
    for block, points in zip(blocks, positions):
        block.data.foreach_set("co", np.asarray(points, np.float32).ravel())
        block.interpolation = "KEY_LINEAR"
    times = [block.frame for block in blocks]
    add_curves(action_of(keys, thing.name), "eval_time", np.asarray(frames, float), np.array(times, float))


def mesh_object(collection, name, vertices, edges=(), faces=(), smooth=False):
    """A new mesh object in a collection."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(*(np.asarray(a).tolist() if isinstance(a, np.ndarray) else list(a) for a in (vertices, edges, faces)))
    if smooth:
        mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    thing = bpy.data.objects.new(name, mesh)
    collection.objects.link(thing)
    return thing


def material_of(name, color):
    """The material of that name, made if need be."""
    material = bpy.data.materials.get(name)
    if material is None:
        material = bpy.data.materials.new(name)
        material.diffuse_color = (*color, 1)
        material.use_nodes = True
        material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1)
    return material
