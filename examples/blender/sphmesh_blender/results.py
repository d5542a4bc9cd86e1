# SPDX-License-Identifier: MIT
"""Levels as objects: spheres, links, thick links, colliders."""
import bpy
import numpy as np

from . import solid
from .animate import action_of, add_curves, add_shapes, material_of, mesh_object

BALL_SUBDIVISIONS = 3


def ball_of(name):
    """A shared mesh: an icosphere of radius 1."""
    import bmesh

    mesh = bpy.data.meshes.new(name)
    made = bmesh.new()
    bmesh.ops.create_icosphere(made, subdivisions=BALL_SUBDIVISIONS, radius=1)
    made.to_mesh(mesh)
    made.free()
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    return mesh


def directions():
    """Vertices and faces of an icosphere of radius 1."""
    ball = ball_of("directions")
    vertices, faces = np.empty(3 * len(ball.vertices)), np.empty(3 * len(ball.polygons), np.int32)
    ball.vertices.foreach_get("co", vertices)
    ball.polygons.foreach_get("vertices", faces)
    bpy.data.meshes.remove(ball)
    vertices = vertices.reshape(-1, 3)
    return vertices / np.linalg.norm(vertices, axis=1, keepdims=True), faces.reshape(-1, 3)


def radii_of(level):
    """Shape (F, K), whether they change or not."""
    return np.broadcast_to(level.radii, (level.frame_count, level.sphere_count)).astype(float)


def make_spheres(collection, level, frames, name):
    """An object for each sphere; they share one mesh, and move by keys."""
    ball, radii = ball_of(name), radii_of(level)
    ball.materials.append(material_of("Sphere-mesh spheres", (0.8, 0.25, 0.1)))
    made = []
    for i in range(level.sphere_count):
        thing = bpy.data.objects.new(f"{name} {i:03d}", ball)
        collection.objects.link(thing)
        action = action_of(thing, thing.name)
        add_curves(action, "location", frames, level.centers[:, i], "Sphere")
        add_curves(action, "scale", frames, np.repeat(radii[:, i, None], 3, axis=1), "Sphere")
        made.append(thing)
    return made


def make_links(collection, level, frames, name):
    """Edges and triangles between the centres, as one mesh."""
    thing = mesh_object(collection, name, level.centers[0], level.edges, level.triangles)
    thing.data.materials.append(material_of("Sphere-mesh links", (0.15, 0.35, 0.8)))
    add_shapes(thing, frames, level.centers)
    return thing


def primitives_of(level):
    """What the solid of a level consists of: triangles, wire edges, and spheres of neither."""
    used = np.unique(np.concatenate([level.edges.ravel(), level.triangles.ravel()]))
    alone = np.setdiff1d(np.arange(level.sphere_count), used)
    return [("wedge", tuple(t)) for t in level.triangles] + [("capsule", tuple(e)) for e in level.edges] + [
        ("sphere", (s,)) for s in alone]


def hulls_of(level):
    """Of every primitive: kind, positions (F, d, 3), faces."""
    around, faces = directions()
    radii, centers = radii_of(level), level.centers.astype(float)
    for kind, spheres in primitives_of(level):
        chosen = list(spheres)
        yield kind, solid.hull(centers[:, chosen], radii[:, chosen], around), faces


def make_solid(collection, level, frames, name):
    """The whole sphere-mesh in one mesh: spheres, cones along edges, and the flat sides of thick triangles."""
    around, faces = directions()
    radii, centers = radii_of(level), level.centers.astype(float)
    pairs = np.concatenate([level.edges, *(level.triangles[:, k] for k in ([0, 1], [1, 2], [2, 0]))]).astype(int)
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    parts = [(solid.balls(centers[:, [k]], radii[:, [k]], around), faces) for k in range(level.sphere_count)]
    parts += [(solid.cone(centers[:, p], radii[:, p]), solid.cone_faces()) for p in pairs]
    parts += [(solid.triangles(centers[:, t], radii[:, t]), solid.triangle_faces()) for t in level.triangles.astype(int)]
    starts = np.cumsum([0] + [points.shape[1] for points, _ in parts])
    whole = np.concatenate([points for points, _ in parts], axis=1)
    corners = [face for start, (_, own) in zip(starts, parts) for face in (own + start).tolist()]
    thing = mesh_object(collection, name, whole[0], faces=corners, smooth=True)
    thing.data.materials.append(material_of("Sphere-mesh links", (0.15, 0.35, 0.8)))
    add_shapes(thing, frames, whole)
    return thing


def make_colliders(context, collection, level, frames, name, physics):
    """An object for each capsule, thick triangle and lone sphere; they are drawn as wires, and not rendered."""
    made = []
    for number, (kind, points, faces) in enumerate(hulls_of(level)):
        thing = mesh_object(collection, f"{name} {kind} {number:03d}", points[0], faces=faces)
        add_shapes(thing, frames, points)
        thing.display_type, thing.hide_render = "WIRE", True
        if physics == "COLLISION":
            thing.modifiers.new("Collision", "COLLISION")
        made.append(thing)
    if physics == "RIGID_BODY":
        _make_rigid(context, collection, made)
    return made


def _make_rigid(context, collection, things):
    """Passive bodies that follow their animation."""
    scene = context.scene
    if scene.rigidbody_world is None:
        bpy.ops.rigidbody.world_add()
    world = scene.rigidbody_world
    if world.collection is None:
        world.collection = bpy.data.collections.new("RigidBodyWorld")
    for thing in things:
        world.collection.objects.link(thing)
    context.view_layer.update()
    for thing in things:
        body = thing.rigid_body
        body.type, body.kinematic = "PASSIVE", True
        body.collision_shape, body.mesh_source, body.use_deform = "CONVEX_HULL", "DEFORM", True
