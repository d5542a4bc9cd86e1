# SPDX-License-Identifier: MIT
"""The add-on with a window, as its user has it: the bar moves, Esc ends it, and undo is there. For addon_window.sh.

    blender --factory-startup --enable-event-simulate -P addon_window.py -- ADDON.zip FOLDER
"""
import os
import sys
import traceback

import bpy

ZIP, FOLDER = (os.path.abspath(a) for a in sys.argv[sys.argv.index("--") + 1:][:2])
STATUS = []


def window_context():
    window = bpy.context.window_manager.windows[0]
    area = next(a for a in window.screen.areas if a.type == "VIEW_3D")
    region = next(r for r in area.regions if r.type == "WINDOW")
    return {"window": window, "area": area, "region": region}


def steps():
    """Each yield lets Blender handle its events."""
    with bpy.context.temp_override(**window_context()):
        bpy.context.space_data.show_region_ui = True
        bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12)
        ball = bpy.context.active_object
        ball.modifiers.new("wave", "WAVE").time_offset = -50
        bpy.context.scene.sphmesh.spheres = 30
    yield
    for stop in (True, False):
        bpy.context.scene.frame_end = 2000 if stop else 15
        before = len(bpy.data.collections), len(bpy.data.objects), bpy.context.scene.frame_current
        with bpy.context.temp_override(**window_context()):
            answer = bpy.ops.sphmesh.make("INVOKE_DEFAULT", spheres=30, links="SOLID")
        assert answer == {"RUNNING_MODAL"}, answer
        seen = set()
        for turn in range(3000):
            yield
            seen.add(bpy.context.scene.frame_current)
            if stop and len(seen) > 2:
                window = bpy.context.window_manager.windows[0]
                window.event_simulate(type="ESC", value="PRESS")
                window.event_simulate(type="ESC", value="RELEASE")
                yield
                yield
                break
            if len(bpy.data.collections) > before[0]:
                break
        for _ in range(20):
            yield
        after = len(bpy.data.collections), len(bpy.data.objects), bpy.context.scene.frame_current
        assert (after == before) == stop, (stop, before, after)
        print(f"ok      {'Esc ends it and leaves nothing' if stop else 'it ends by itself'}, "
              f"after {len(seen)} frames were shown", flush=True)
    with bpy.context.temp_override(**window_context()):
        bpy.ops.ed.undo()
    yield
    assert len(bpy.data.collections) == before[0]
    print("ok      undo takes it back", flush=True)
    with bpy.context.temp_override(**window_context()):
        bpy.ops.ed.redo()
    yield
    with bpy.context.temp_override(**window_context()):
        bpy.ops.screen.screenshot(filepath=os.path.join(FOLDER, "window.png"))


def drive(running):
    try:
        next(running)
        return 0.02
    except StopIteration:
        STATUS.append(0)
    except Exception:
        print("FAILED  " + traceback.format_exc(), flush=True)
        STATUS.append(1)
    os._exit(STATUS[0])  # Blender would ask whether to save


bpy.context.preferences.view.show_splash = False
bpy.ops.preferences.addon_install(filepath=ZIP, overwrite=True)
bpy.ops.preferences.addon_enable(module="sphmesh_blender")
running = steps()
bpy.app.timers.register(lambda: drive(running), first_interval=1)
