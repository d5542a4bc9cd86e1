# SPDX-License-Identifier: MIT
"""From an object to a collection, in steps: between any two Blender may draw, and the user may press Esc."""
import threading

import bpy
import numpy as np

from . import library, results, rig
from .capture import Capture

CAPTURED = 0.4  # how much of the bar capturing takes


class Failed(Exception):
    """For the user."""


class _Work(threading.Thread):
    """The library at work, off Blender's thread: it touches no data of Blender's."""

    def __init__(self, task):
        super().__init__(daemon=True)
        self.task, self.fraction, self.stage, self.stopped = task, 0.0, "", False
        self.result = self.error = None

    def report(self, stage, fraction):
        self.stage, self.fraction = stage, fraction
        return not self.stopped

    def run(self):
        try:
            self.result = self.task(self.report)
        except Exception as error:  # told on Blender's thread
            self.error = error

    def stop(self):
        self.stopped = True
        self.join()


def compute(package, capture, settings, report):
    """What the library makes of the frames: a level, and for a rig a skin and its skeleton."""
    animation = package.Animation(capture.positions, capture.triangles, capture.edges)
    hierarchy = animation.build(radius=settings.radius.lower(), progress=report)
    count = min(max(settings.spheres, hierarchy.least_count), hierarchy.vertex_count)
    level = hierarchy.level(count)
    hierarchy.close()
    if settings.optimize:
        level = level.optimized(animation, progress=report)
    if settings.conservative:
        level = level.inflated(animation, progress=report)
    if settings.result != "RIG":
        return level, None, None
    skin = level.skin(animation, mode=settings.weights.lower(), influences=settings.influences, progress=report)
    return level, skin, skin.skeleton(layout=settings.skeleton.lower())


def frames_of(scene, settings):
    """The numbers of the frames to capture."""
    start, end = (scene.frame_start, scene.frame_end) if settings.scene_range else (settings.frame_start,
                                                                                   settings.frame_end)
    if end < start:
        raise Failed(f"The range ends at {end}, before it starts at {start}")
    return list(range(start, end + 1, settings.frame_step))


def run(context, thing, settings, preferences=None):
    """Yields (fraction, what is being done); the value is the collection that was made.

    Whatever happens, closing the generator included, the scene is left at the frame where it was, and nothing half made
    stays behind.
    """
    try:
        package = library.load(*(preferences or ("", "")))
    except (ImportError, OSError) as error:
        raise Failed(str(error)) from error
    scene, before = context.scene, (context.scene.frame_current, context.scene.frame_subframe)
    work = collection = None
    done = False
    try:
        capture = Capture(thing, frames_of(scene, settings))
        for index, frame in enumerate(capture.frames):
            capture.add(context, index)
            yield CAPTURED * (index + 1) / len(capture.frames), f"frame {frame}"
        work = _Work(lambda report: compute(package, capture, settings, report))
        work.start()
        while work.is_alive():
            work.join(0.05)
            yield CAPTURED + (0.95 - CAPTURED) * work.fraction, work.stage
        if isinstance(work.error, package.SphmeshError):
            raise Failed(str(work.error)) from work.error
        if work.error is not None:
            raise work.error
        collection = bpy.data.collections.new(f"{thing.name} sphere-mesh")
        scene.collection.children.link(collection)
        make(context, collection, thing, settings, capture, *work.result)
        done = True
        return collection
    finally:
        if work is not None:
            work.stop()
        if collection is not None and not done:
            remove(collection)
        scene.frame_set(before[0], subframe=before[1])


def make(context, collection, thing, settings, capture, level, skin, skeleton):
    """The objects."""
    frames, name = np.array(capture.frames, float), thing.name
    if settings.result == "RIG":
        rig.make_rig(context, collection, capture, skin, skeleton, name)
    elif settings.result == "COLLIDERS":
        results.make_colliders(context, collection, level, frames, name, settings.physics)
    elif settings.links == "SOLID":
        results.make_solid(collection, level, frames, f"{name} solid")
    else:
        results.make_spheres(collection, level, frames, f"{name} sphere")
        if settings.links == "LINES":
            results.make_links(collection, level, frames, f"{name} links")


def remove(collection):
    """A collection and all that is in it alone."""
    for thing in list(collection.objects):
        data = thing.data
        bpy.data.objects.remove(thing)
        if data is not None and data.users == 0:
            bpy.data.batch_remove([data])
    bpy.data.collections.remove(collection)
