# SPDX-License-Identifier: MIT
"""Sphere-meshes of animated objects: spheres and links, rigs with weights, colliders."""
bl_info = {
    "name": "Sphere-meshes",
    "author": "libsphmesh",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Sphere-mesh",
    "description": "Animated spheres and links, rigs and colliders from anything that Blender can play",
    "category": "Animation",
}


def register():
    from . import interface

    interface.register()


def unregister():
    from . import interface

    interface.unregister()
