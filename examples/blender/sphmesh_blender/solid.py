# SPDX-License-Identifier: MIT
"""Shapes between spheres, whose faces are the same in all frames: hulls, cones around edges, and tangent triangles.

Centres are (F, s, 3), radii (F, s), and positions come as (F, n, 3).
"""
import numpy as np

SIDES = 24


def hull(centers, radii, around):
    """The convex hull of spheres: for each direction of `around`, (n, 3), the point that is farthest that way."""
    farthest = (centers @ around.T + radii[..., None]).argmax(axis=1)  # (F, n)
    frames = np.arange(len(centers))[:, None]
    return centers[frames, farthest] + radii[frames, farthest][..., None] * around


def balls(centers, radii, around):
    """Whole spheres, one after another."""
    return (centers[:, :, None] + radii[:, :, None, None] * around).reshape(len(centers), -1, 3)


def _beside(axes):
    """Unit vectors (F, 3) at right angles to `axes`, which turn from frame to frame as little as they can."""
    out = np.empty_like(axes)
    before = np.eye(3)[np.abs(axes[0]).argmin()]
    for frame, axis in enumerate(axes):
        across = before - (before @ axis) * axis
        if np.linalg.norm(across) < 1e-6:
            across = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
        before = out[frame] = across / np.linalg.norm(across)
    return out


def cone(centers, radii):
    """The cone that touches two spheres, between the circles where it does; nothing where one is within the other."""
    way = centers[:, 1] - centers[:, 0]
    length = np.linalg.norm(way, axis=1)
    apart = length > np.abs(radii[:, 0] - radii[:, 1])
    axis = np.where(apart[:, None], way / np.where(apart, length, 1)[:, None], [0, 0, 1])
    slope = np.where(apart, (radii[:, 0] - radii[:, 1]) / np.where(apart, length, 1), 1)
    side = _beside(axis)
    turns = 2 * np.pi * np.arange(SIDES) / SIDES
    ring = (np.cos(turns)[:, None] * side[:, None] + np.sin(turns)[:, None] * np.cross(axis, side)[:, None])
    normal = slope[:, None, None] * axis[:, None] + np.sqrt(1 - slope ** 2)[:, None, None] * ring  # (F, SIDES, 3)
    return np.concatenate([centers[:, k, None] + radii[:, k, None, None] * normal for k in (0, 1)], axis=1)


def cone_faces():
    a = np.arange(SIDES)
    b = np.roll(a, -1)
    return np.stack([a, b, b + SIDES, a + SIDES], 1)


def triangles(centers, radii):
    """The two triangles that touch three spheres; nothing where there are none."""
    u, v = centers[:, 1] - centers[:, 0], centers[:, 2] - centers[:, 0]
    fall = radii[:, :1] - radii[:, 1:]  # how much the normals rise along u and v
    normal = np.cross(u, v)
    square = (normal ** 2).sum(axis=1)
    flat = square <= 1e-12 * ((u ** 2).sum(axis=1) + (v ** 2).sum(axis=1)) ** 2
    square = np.where(flat, 1, square)
    within = (np.cross(v, normal) * fall[:, :1] + np.cross(normal, u) * fall[:, 1:]) / square[:, None]
    rest = 1 - (within ** 2).sum(axis=1)
    there = ~flat & (rest > 0)
    upward = normal * np.sqrt(np.where(there, rest, 0) / square)[:, None]
    reach = np.where(there[:, None], radii, 0)[..., None]
    return np.concatenate([centers + reach * (within + sign * upward)[:, None] for sign in (1, -1)], axis=1)


def triangle_faces():
    return np.array([[0, 1, 2], [5, 4, 3]])
