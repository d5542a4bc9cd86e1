# SPDX-License-Identifier: MIT
"""What the user sees: preferences, an operator, a panel."""
import time

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from . import job
from .capture import CaptureError

PATIENCE = 0.05  # seconds between looks at the keyboard
SHAPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


class SPHMESH_preferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    package_folder: StringProperty(name="Python package", subtype="DIR_PATH", description="The folder that has the "
                                   "Python package sphmesh; empty: the add-on's own, or where Python looks")
    library_folder: StringProperty(name="Libraries", subtype="DIR_PATH", description="The folder that has "
                                   "libsphmesh; empty: the add-on's own, or where the system looks")

    def draw(self, context):
        self.layout.prop(self, "package_folder")
        self.layout.prop(self, "library_folder")


def preferences_of(context):
    addon = context.preferences.addons.get(__package__)
    if addon is None:
        return "", ""
    return tuple(bpy.path.abspath(p) for p in (addon.preferences.package_folder, addon.preferences.library_folder))


class SPHMESH_OT_make(bpy.types.Operator):
    """Make a sphere-mesh of the active object as it plays: every modifier is evaluated in every frame"""

    bl_idname = "sphmesh.make"
    bl_label = "Make Sphere-mesh"
    bl_options = {"REGISTER", "UNDO"}

    spheres: IntProperty(name="Spheres", default=20, min=1, soft_max=500, description="How many spheres")
    result: EnumProperty(name="Make", items=[
        ("SPHERES", "Spheres", "Animated spheres, and links between them"),
        ("RIG", "Rig", "An armature with a bone for each sphere, animated, and the mesh with weights"),
        ("COLLIDERS", "Colliders", "A collision object for each capsule, thick triangle and lone sphere")])
    links: EnumProperty(name="Links", items=[
        ("LINES", "Lines", "Edges and triangles between the centres, as a mesh"),
        ("SOLID", "Solid", "Spheres, tapered capsules and thick triangles: the whole sphere-mesh as one mesh"),
        ("NONE", "None", "Spheres alone")])
    radius: EnumProperty(name="Radii", items=[
        ("CONSTANT", "Constant", "A sphere has one radius in all frames"),
        ("PER_FRAME", "Per Frame", "Radii change from frame to frame")])
    optimize: BoolProperty(name="Optimize Links", default=True,
                           description="Give every vertex to the nearest of the spheres around it, and link accordingly")
    conservative: BoolProperty(name="Contain the Mesh", default=False,
                               description="Let radii grow until every vertex is inside in every frame")
    physics: EnumProperty(name="Physics", items=[
        ("NONE", "None", "Shapes alone"),
        ("COLLISION", "Collision", "For cloth, soft bodies and particles"),
        ("RIGID_BODY", "Rigid Body", "Passive bodies that follow their animation")])
    weights: EnumProperty(name="Weights", default="ANIMATION", items=[
        ("ANIMATION", "Animation", "As near to the animation as weights can be"),
        ("MIXED", "Mixed", "Smooth weights, learned from the animation where that tells"),
        ("GEOMETRIC", "Geometric", "Smooth weights")])
    influences: IntProperty(name="Bones per Vertex", default=4, min=1, max=16)
    skeleton: EnumProperty(name="Bones", items=[
        ("TREE", "Tree", "Bones hang on one another, where they turn"), ("FLAT", "Flat", "No bone hangs on another")])
    scene_range: BoolProperty(name="Scene's Frames", default=True, description="The frame range of the scene")
    frame_start: IntProperty(name="Start", default=1)
    frame_end: IntProperty(name="End", default=250)
    frame_step: IntProperty(name="Step", default=1, min=1)

    _timer = _steps = None

    @classmethod
    def poll(cls, context):
        thing = context.active_object
        return thing is not None and thing.type in SHAPES and context.mode == "OBJECT"

    def start(self, context):
        return job.run(context, context.active_object, self, preferences_of(context))

    def execute(self, context):
        try:
            for _ in self.start(context):
                pass
        except (job.Failed, CaptureError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}

    def invoke(self, context, event):
        self._steps = self.start(context)
        self._timer = context.window_manager.event_timer_add(0.01, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type in {"ESC"}:
            self._steps.close()
            self.report({"INFO"}, "Cancelled: nothing was made")
            return self.end(context, {"CANCELLED"})
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        until = time.monotonic() + PATIENCE
        try:
            while time.monotonic() < until:
                fraction, what = next(self._steps)
        except StopIteration:
            return self.end(context, {"FINISHED"})
        except (job.Failed, CaptureError) as error:
            self.report({"ERROR"}, str(error))
            return self.end(context, {"CANCELLED"})
        except Exception:
            self.end(context, set())
            raise
        context.window_manager.progress_update(100 * fraction)
        context.workspace.status_text_set(f"Sphere-mesh: {100 * fraction:.0f} %, {what}. Esc cancels")
        return {"RUNNING_MODAL"}

    def end(self, context, answer):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)
        return answer

    def draw(self, context):
        draw_settings(self.layout, self)


def draw_settings(layout, settings):
    layout.use_property_split, layout.use_property_decorate = True, False
    layout.prop(settings, "spheres")
    layout.prop(settings, "result")
    if settings.result == "SPHERES":
        layout.prop(settings, "links")
    if settings.result == "COLLIDERS":
        layout.prop(settings, "physics")
    if settings.result == "RIG":
        for name in ("weights", "influences", "skeleton"):
            layout.prop(settings, name)
    else:
        for name in ("radius", "optimize", "conservative"):
            layout.prop(settings, name)
    layout.prop(settings, "scene_range")
    if not settings.scene_range:
        layout.prop(settings, "frame_start")
        layout.prop(settings, "frame_end")
    layout.prop(settings, "frame_step")


# The panel keeps the same settings, so that they are there before the operator runs.
SPHMESH_settings = type("SPHMESH_settings", (bpy.types.PropertyGroup,),
                        {"__annotations__": dict(SPHMESH_OT_make.__annotations__)})


class SPHMESH_PT_panel(bpy.types.Panel):
    bl_label = "Sphere-mesh"
    bl_idname = "SPHMESH_PT_panel"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Sphere-mesh"

    def draw(self, context):
        settings = context.scene.sphmesh
        draw_settings(self.layout, settings)
        button = self.layout.operator(SPHMESH_OT_make.bl_idname)
        for name in SPHMESH_settings.__annotations__:
            setattr(button, name, getattr(settings, name))


CLASSES = (SPHMESH_preferences, SPHMESH_OT_make, SPHMESH_settings, SPHMESH_PT_panel)


def menu(self, context):
    self.layout.operator(SPHMESH_OT_make.bl_idname)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.sphmesh = bpy.props.PointerProperty(type=SPHMESH_settings)
    bpy.types.VIEW3D_MT_object_animation.append(menu)


def unregister():
    bpy.types.VIEW3D_MT_object_animation.remove(menu)
    del bpy.types.Scene.sphmesh
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
