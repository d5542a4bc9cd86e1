# SPDX-License-Identifier: MIT
"""The add-on, from its zip, in Blender without a window: what it makes must play as what it was made of.

    blender -b --factory-startup -P addon_check.py -- ADDON.zip FOLDER

FOLDER has creature.obj and creature.pc2 of `sphmesh demo`, and takes pictures. One line "ok ..." or "FAILED ..." per check.
"""
import importlib
import math
import os
import sys
import traceback
import types

import bpy
import numpy as np
from mathutils.bvhtree import BVHTree

ZIP, FOLDER = (os.path.abspath(a) for a in sys.argv[sys.argv.index("--") + 1:][:2])
FRAMES = 8
SIDE = 20  # degrees from which the creature is looked at
checks, failed = [], []


def check(body):
    checks.append(body)
    return body


def evaluated(thing, frame):
    """Vertices in the world, as Blender shows them."""
    bpy.context.scene.frame_set(int(frame), subframe=frame - int(frame))
    shown = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    out = np.empty(3 * len(shown.data.vertices), np.float32)
    shown.data.vertices.foreach_get("co", out)
    matrix = np.array(shown.matrix_world)
    return out.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]


def place(thing, frame):
    bpy.context.scene.frame_set(int(frame), subframe=frame - int(frame))
    shown = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return np.array(shown.matrix_world.translation), shown.matrix_world.to_scale()[0]


def choose(thing):
    bpy.ops.object.select_all(action="DESELECT")
    thing.select_set(True)
    bpy.context.view_layer.objects.active = thing


def make(thing, **settings):
    choose(thing)
    before = set(bpy.data.collections)
    assert bpy.ops.sphmesh.make(**settings) == {"FINISHED"}
    collection, = (c for c in set(bpy.data.collections) - before if c.name.startswith(thing.name))
    return collection


def worm():
    """A tube under a shape key, a wave, an armature and a subdivision, whose object moves too."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="sphmesh_blender")
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, FRAMES
    bpy.ops.mesh.primitive_cylinder_add(vertices=12, radius=0.3, depth=3)
    tube = bpy.context.active_object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide(number_cuts=3)
    bpy.ops.object.mode_set(mode="OBJECT")
    tube.shape_key_add(name="Basis")
    swollen = tube.shape_key_add(name="swollen")
    for point in swollen.data:
        if point.co.z > 0.5:
            point.co.x *= 1.7
    swollen.keyframe_insert("value", frame=1)
    swollen.value = 1
    swollen.keyframe_insert("value", frame=FRAMES)
    wave = tube.modifiers.new("wave", "WAVE")
    wave.height, wave.time_offset = 0.1, -20
    bpy.ops.object.armature_add(location=(0, 0, 0))
    rig = bpy.context.active_object
    tube.modifiers.new("bones", "ARMATURE").object = rig
    group = tube.vertex_groups.new(name="Bone")
    for vertex in tube.data.vertices:
        group.add([vertex.index], min(max(vertex.co.z + 0.5, 0), 1), "REPLACE")
    bone = rig.pose.bones["Bone"]
    bone.rotation_mode = "XYZ"
    bone.keyframe_insert("rotation_euler", frame=1)
    bone.rotation_euler.x = 1
    bone.keyframe_insert("rotation_euler", frame=FRAMES)
    tube.modifiers.new("fine", "SUBSURF").levels = 1
    tube.keyframe_insert("location", frame=1)
    tube.location, tube.rotation_euler = (1, 2, 0), (0, 0.5, 0)
    tube.keyframe_insert("location", frame=FRAMES)
    tube.keyframe_insert("rotation_euler", frame=FRAMES)
    return tube


def level_of(thing, spheres, optimize=True):
    """The same by the library alone, from frames that are taken here."""
    package = importlib.import_module("sphmesh_blender.sphmesh")
    frames = np.stack([evaluated(thing, f) for f in range(1, FRAMES + 1)]).astype(np.float32)
    bpy.context.scene.frame_set(1)
    mesh = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    mesh.calc_loop_triangles()
    triangles = [tuple(t.vertices) for t in mesh.loop_triangles]
    animation = package.Animation(frames, triangles)
    level = animation.build().level(spheres)
    return package, animation, level.optimized(animation) if optimize else level, frames


@check
def spheres_and_links_play_as_the_level():
    tube = worm()
    collection = make(tube, spheres=15)
    _, _, level, _ = level_of(tube, 15)
    balls = sorted((o for o in collection.objects if " sphere " in o.name), key=lambda o: o.name)
    links, = (o for o in collection.objects if o.name.endswith("links"))
    assert len(balls) == 15 and len({o.data for o in balls}) == 1
    for frame in (1, 4, FRAMES, 2.5):
        low, part = int(frame) - 1, frame % 1
        centers = level.centers[low] * (1 - part) + level.centers[min(low + 1, FRAMES - 1)] * part
        found = [place(o, frame) for o in balls]
        assert np.abs(np.array([p for p, _ in found]) - centers).max() < 1e-4
        assert np.abs(np.array([s for _, s in found]) - level.radii).max() < 1e-5
        assert np.abs(evaluated(links, frame) - centers).max() < 1e-4
    assert len(links.data.polygons) == len(level.triangles)
    return f"15 spheres, {len(level.edges)} edges, {len(level.triangles)} triangles, also between frames"


@check
def radii_may_change_from_frame_to_frame():
    tube = worm()
    collection = make(tube, spheres=6, radius="PER_FRAME", links="NONE")
    balls = list(collection.objects)
    sizes = np.array([[place(o, f)[1] for o in balls] for f in range(1, FRAMES + 1)])
    assert len(balls) == 6 and (sizes.max(axis=0) > 1.01 * sizes.min(axis=0)).any()


@check
def the_solid_is_that_of_the_level():
    tube = worm()
    solid, = make(tube, spheres=10, links="SOLID").objects
    _, _, level, _ = level_of(tube, 10)
    for frame in (1, 5, FRAMES):
        off = level.query(frame - 1).distance(evaluated(solid, frame))
        assert off.max() < 1e-5, off.max()  # no point is outside
    graph = bpy.context.evaluated_depsgraph_get()  # of the last frame
    tree = BVHTree.FromObject(solid, graph)
    rng, query = np.random.default_rng(2), level.query(FRAMES - 1)
    middle = level.centers[-1].mean(axis=0)
    start, end = (middle + 6 * rng.normal(size=(400, 3)) for _ in range(2))
    end = start + 3 * (middle + 0.5 * rng.normal(size=(400, 3)) - start)
    hits = query.cast(start, end)
    worst = seen = 0
    for a, b, hit in zip(start, end, hits):
        point = tree.ray_cast(a, b - a)[0]
        if hit["hit"] and hit["depth"] == 0 and (hit["contact"]["normal"] @ (b - a)) < -0.3 * np.linalg.norm(b - a):
            seen += 1
            assert point is not None
            worst = max(worst, np.linalg.norm(np.array(point) - hit["contact"]["point"]))
    assert seen > 50 and worst < 0.05, (seen, worst)
    return f"{seen} rays hit it within {worst:.3f} of where the library has it"


@check
def a_rig_plays_as_the_animation():
    tube = worm()
    collection = make(tube, spheres=12, result="RIG")
    armature, = (o for o in collection.objects if o.type == "ARMATURE")
    mesh, = (o for o in collection.objects if o.type == "MESH")
    package, animation, level, frames = level_of(tube, 12)
    skin = level.skin(animation, mode="animation")
    expected = skin.deformer().pose(skin.transforms).positions
    size = animation.bounding_diagonal()
    off = np.array([np.linalg.norm(evaluated(mesh, f + 1) - frames[f], axis=1) for f in range(FRAMES)])
    same = max(np.abs(evaluated(mesh, f + 1) - expected[f]).max() for f in range(FRAMES))
    assert len(armature.data.bones) == 12 and sum(b.parent is None for b in armature.data.bones) == 1
    assert same < 1e-5 * size, same / size
    rmse = math.sqrt((off ** 2).mean())
    assert rmse < 0.01 * size, rmse / size
    assert len(mesh.data.polygons) == len(tube.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.polygons)
    return f"{100 * rmse / size:.3f} % of the diagonal off the animation, {same / size:.1e} off the library's own skinning"


def volume(points, triangles):
    a, b, c = (points[np.array(triangles)[:, k]].astype(float) for k in range(3))
    return float((np.cross(a, b) * c).sum() / 6)


@check
def an_object_that_is_mirrored_is_not_turned_inside_out():
    tube = worm()
    tube.scale.x = -1
    mesh, = (o for o in make(tube, spheres=5, result="RIG").objects if o.type == "MESH")
    solid, = make(tube, spheres=5, links="SOLID").objects
    for thing in (mesh, solid):
        thing.data.calc_loop_triangles()
        assert volume(evaluated(thing, 1), [tuple(t.vertices) for t in thing.data.loop_triangles]) > 0.3


@check
def colliders_contain_the_mesh_where_that_is_wanted():
    tube = worm()
    collection = make(tube, spheres=10, result="COLLIDERS", physics="RIGID_BODY", conservative=True)
    package, animation, level, frames = level_of(tube, 10)
    bodies = list(collection.objects)
    assert all(o.rigid_body.kinematic and o.rigid_body.collision_shape == "CONVEX_HULL" and o.hide_render for o in bodies)
    sticking = max(outside(frames[f - 1], [evaluated(o, f) for o in bodies]) for f in (1, FRAMES))
    assert sticking < 0.03, sticking  # what an icosphere of 162 vertices lacks of its sphere
    return f"{len(bodies)} bodies, vertices stick out by {sticking:.3f} at most"


@check
def balls_of_physics_bounce_off_colliders():
    tube = worm()
    bpy.context.scene.frame_end = 30
    for f in list(tube.animation_data.action.fcurves):
        tube.animation_data.action.fcurves.remove(f)
    tube.location, tube.rotation_euler = (0, 0, 0), (0, math.pi / 2, 0)
    bpy.context.scene.frame_set(1)
    make(tube, spheres=10, result="COLLIDERS", physics="RIGID_BODY")
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.2, location=(0, 0, 1.5))
    falling = bpy.context.active_object
    bpy.ops.rigidbody.object_add(type="ACTIVE")
    falling.rigid_body.collision_shape = "SPHERE"
    heights = [place(falling, f)[0][2] for f in range(1, 31)]
    free = 1.5 - 9.81 / 2 * (29 / 24) ** 2
    assert heights[0] > heights[5] and min(heights) > free + 1, (min(heights), free)
    return f"lowest at {min(heights):.2f}, which would have fallen to {free:.2f}"


@check
def a_topology_that_changes_is_told_with_its_frame():
    tube = worm()
    build = tube.modifiers.new("grow", "BUILD")
    build.frame_start, build.frame_duration = -5, 30
    choose(tube)
    before = [len(d) for d in (bpy.data.objects, bpy.data.meshes, bpy.data.collections, bpy.data.actions)]
    try:
        bpy.ops.sphmesh.make()
    except RuntimeError as error:
        told = str(error)
    assert "Frame 2 has " in told and "frame 1 has " in told, told
    assert before == [len(d) for d in (bpy.data.objects, bpy.data.meshes, bpy.data.collections, bpy.data.actions)]
    return told.strip().split("\n")[0]


@check
def cancelling_leaves_nothing_behind():
    tube = worm()
    choose(tube)
    job = importlib.import_module("sphmesh_blender.job")
    kinds = (bpy.data.objects, bpy.data.meshes, bpy.data.collections, bpy.data.actions, bpy.data.shape_keys)
    for stop_at in (0.1, 0.41, 0.6):
        bpy.context.scene.frame_set(3)
        before = [len(d) for d in kinds]
        settings = types.SimpleNamespace(spheres=5, result="SPHERES", links="LINES", radius="CONSTANT", optimize=True,
                                         conservative=False, scene_range=True, frame_step=1)
        steps = job.run(bpy.context, tube, settings)
        for fraction, what in steps:
            if fraction >= stop_at:
                steps.close()
                break
        assert before == [len(d) for d in kinds] and bpy.context.scene.frame_current == 3


@check
def undo_takes_everything_back():
    tube = worm()
    choose(tube)
    bpy.ops.ed.undo_push(message="before")
    name, before = tube.name, len(bpy.data.objects)
    make(tube, spheres=5)
    bpy.ops.ed.undo_push(message="after")
    assert len(bpy.data.objects) == before + 6
    bpy.ops.ed.undo()
    assert len(bpy.data.objects) == before and name in bpy.data.objects


@check
def a_range_and_a_step_are_taken():
    tube = worm()
    collection = make(tube, spheres=4, links="NONE", scene_range=False, frame_start=2, frame_end=8, frame_step=3)
    times = {round(k.co[0]) for o in collection.objects for c in o.animation_data.action.fcurves for k in c.keyframe_points}
    assert times <= {2, 5, 8} and {5, 8} <= times
    choose(tube)
    try:
        bpy.ops.sphmesh.make(scene_range=False, frame_start=5, frame_end=4)
    except RuntimeError as error:
        assert "ends at 4" in str(error)
    else:
        raise AssertionError("no error")


@check
def a_curve_without_faces_has_wire_edges():
    worm()
    bpy.ops.curve.primitive_bezier_circle_add()
    collection = make(bpy.context.active_object, spheres=6)
    links, = (o for o in collection.objects if o.name.endswith("links"))
    assert len(links.data.edges) == 6 and len(links.data.polygons) == 0


@check
def the_panel_has_the_settings_of_the_operator():
    worm()
    settings = bpy.context.scene.sphmesh
    names = [p.identifier for p in bpy.ops.sphmesh.make.get_rna_type().properties if p.identifier != "rna_type"]
    assert all(hasattr(settings, n) for n in names) and settings.spheres == 20


def light_and_camera(target, width):
    """A camera without perspective, from the side and a little from above; what it sees has no background."""
    scene = bpy.context.scene
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    camera.data.type, camera.data.ortho_scale = "ORTHO", width
    camera.rotation_euler = (math.radians(78), 0, math.radians(SIDE))
    bpy.context.view_layer.update()
    camera.location = np.array(target) + 10 * width * np.array(camera.matrix_world.to_3x3())[:, 2]
    scene.camera = camera
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.rotation_euler, sun.data.energy, sun.data.angle = (math.radians(40), 0, math.radians(SIDE - 40)), 2, 0.3
    scene.collection.objects.link(sun)
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (1, 1, 1, 1)
    scene.world.node_tree.nodes["Background"].inputs[1].default_value = 0.5
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 48, False
    scene.render.film_transparent, scene.view_settings.view_transform = True, "Standard"


def plain(name, color, alpha=1.0):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value, inputs["Alpha"].default_value = (*color, 1), alpha
    return material


def render(path, width, height):
    """The picture on white, as numbers from 0 to 1."""
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y, render.filepath = width, height, path
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    pixels = np.array(image.pixels, np.float32).reshape(height, width, 4)
    pixels[..., :3] = pixels[..., :3] * pixels[..., 3:] + 1 - pixels[..., 3:]
    pixels[..., 3] = 1
    image.pixels.foreach_set(pixels.ravel())
    image.save()
    return pixels[..., :3]


def creature():
    """The program's own creature: a mesh under a point cache."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="sphmesh_blender")
    bpy.ops.wm.obj_import(filepath=os.path.join(FOLDER, "creature.obj"), forward_axis="Y", up_axis="Z")
    thing = bpy.context.selected_objects[0]
    cache = thing.modifiers.new("cache", "MESH_CACHE")
    cache.cache_format, cache.filepath = "PC2", os.path.join(FOLDER, "creature.pc2")
    cache.forward_axis, cache.up_axis = "POS_Y", "POS_Z"
    thing.rotation_euler = (math.pi / 2, 0, 0)  # its y is up
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 12
    return thing


@check
def the_creature_has_its_picture():
    """Side by side: the creature, its spheres and links, the solid, and the rig's bones."""
    thing = creature()
    scene = bpy.context.scene
    points = np.concatenate([evaluated(thing, f) for f in (1, 6, 12)])
    low, high = points.min(axis=0), points.max(axis=0)
    size = float(np.linalg.norm(high - low))
    spheres = make(thing, spheres=40, links="LINES")
    solid = make(thing, spheres=40, links="SOLID")
    rig = make(thing, spheres=40, result="RIG")
    bones = draw_bones(rig)
    links, = (o for o in spheres.objects if o.name.endswith("links"))
    links.modifiers.new("lines", "SKIN")
    for vertex in links.data.skin_vertices[0].data:
        vertex.radius = (0.006 * size, 0.006 * size)
    thing.data.materials.clear()
    thing.data.materials.append(plain("clay", (0.5, 0.45, 0.4)))
    for o in rig.objects:
        if o.type == "MESH":
            o.data.materials.clear()
            o.data.materials.append(plain("glass", (0.5, 0.45, 0.4), 0.3))
    right = np.array([math.cos(math.radians(SIDE)), math.sin(math.radians(SIDE)), 0])
    step = 0.72 * size
    for number, things in enumerate(([thing], spheres.objects, solid.objects, [*rig.objects, *bones])):
        root = bpy.data.objects.new(f"place {number}", None)
        scene.collection.objects.link(root)
        root.location = step * (number - 1.5) * right
        for o in things:
            if o.parent is None:
                o.parent = root
    light_and_camera((low + high) / 2, 4.1 * step)
    scene.frame_set(5)
    pixels = render(os.path.join(FOLDER, "addon.png"), 800, 200)
    for column in range(4):  # something is drawn in each quarter
        part = pixels[:, 200 * column:200 * column + 200]
        assert 0.05 < (part.min(axis=2) < 0.9).mean() < 0.6, column


def draw_bones(collection):
    """Sticks for the bones of an armature, as its own drawing is not rendered."""
    armature, = (o for o in collection.objects if o.type == "ARMATURE")
    material = plain("bones", (0.05, 0.3, 0.1))
    sticks = []
    for bone in armature.data.bones:
        bpy.ops.mesh.primitive_cone_add(radius1=0.16 * bone.length, radius2=0.02 * bone.length, depth=bone.length)
        stick = bpy.context.active_object
        stick.data.materials.append(material)
        stick.parent, stick.parent_type, stick.parent_bone = armature, "BONE", bone.name
        stick.rotation_euler = (-math.pi / 2, 0, 0)
        stick.location = (0, -bone.length / 2, 0)
        sticks.append(stick)
    return sticks


def outside(points, hulls):
    """How far points are outside a union of convex meshes: by 300 directions, of each point to the nearest hull."""
    rng = np.random.default_rng(1)
    ways = rng.normal(size=(300, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    along = points @ ways.T
    return float(np.min([(along - (h @ ways.T).max(axis=0)).max(axis=1) for h in hulls], axis=0).max())



bpy.ops.preferences.addon_install(filepath=ZIP, overwrite=True)
wanted = sys.argv[sys.argv.index("--") + 3:]
for body in checks:
    if wanted and body.__name__ not in wanted:
        continue
    try:
        note = body()
        print(f"ok      {body.__name__.replace('_', ' ')}" + (f": {note}" if note else ""), flush=True)
    except Exception:
        failed.append(body.__name__)
        print(f"FAILED  {body.__name__.replace('_', ' ')}\n{traceback.format_exc()}", flush=True)
print(f"{'FAILED' if failed else 'ok'}      {len(failed)} checks failed in Blender {bpy.app.version_string}")
sys.exit(1 if failed else 0)
