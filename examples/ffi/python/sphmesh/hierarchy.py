# SPDX-License-Identifier: MIT
"""The hierarchy of sphere-meshes of an animated mesh, and a cursor that walks it."""
from __future__ import annotations

import ctypes
from typing import Any, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _abi
from ._arrays import COLLAPSE, Floats, Indices, address, filled, struct_at, tight
from ._calls import Context, Handle, Owned, Progress, choice, default_context, options, report
from ._library import lib
from .animation import Animation, PathLike, encoded
from .level import Level


def written(context: Context, function: Any, pointer: int) -> bytes:
    """What a function writes through sph_write_fn."""
    parts = bytearray()

    def take(user: Optional[int], memory: int, size: int) -> int:
        try:
            parts.extend((ctypes.c_char * size).from_address(memory))
        except BaseException as error:
            report(error)
            return _abi.SPH_E_NOMEM
        return _abi.SPH_OK

    context.run(function, pointer, _abi.sph_write_fn(take), None)
    return bytes(parts)


class Hierarchy(Owned):
    """All levels of detail of one animated mesh, from a sphere per vertex to one per connected component."""

    @classmethod
    def build(cls, animation: Animation, *, importance: str = "curvature", radius: str = "constant",
              radius_factor: Optional[float] = None, temporal_coherence: float = 0,
              width_directions: Optional[int] = None, orientation: str = "outward",
              weights: Optional[ArrayLike] = None, progress: Optional[Progress] = None) -> Hierarchy:
        """Collapses edges of the mesh, the cheapest first.

        Args:
            importance: "curvature" or "none": whether tips count besides area. With `weights` they alone count.
            radius: "constant" over all frames, "per_frame", or "zero".
            radius_factor: bound of the radius, in widths of the region; 3/4 if not given.
            temporal_coherence: how much spheres are held back from moving within their region; 0: not at all.
            width_directions: how many directions a region's width is taken over.
            orientation: "outward": components that are inside out are turned; "as_given".
            weights: shape (n,) or (F, n): how much each vertex counts.

        Raises:
            CancelledError: progress was answered with False.
        """
        how = options(_abi.sph_hierarchy_options, radius_mode=choice("SPH_RADIUS_", radius),
                      radius_factor=radius_factor, temporal_coherence=temporal_coherence,
                      width_directions=width_directions, orientation=choice("SPH_ORIENTATION_", orientation),
                      importance=choice("SPH_IMPORTANCE_", importance))
        if weights is not None:
            array = np.asarray(weights)
            per_frame = array.ndim == 2
            array = tight(array, np.float32, *([animation.frame_count] if per_frame else []), animation.vertex_count)
            how.importance, how.importance_weights = _abi.SPH_IMPORTANCE_CALLER, address(array)
            how.importance_frame_stride = animation.vertex_count if per_frame else 0
        pointer = animation.context.make(lib.sph_hierarchy_create, animation._pointer, ctypes.byref(how),
                                         progress=progress)
        return cls._own(animation.context, pointer, lib.sph_hierarchy_destroy)

    @classmethod
    def load(cls, path: PathLike, *, context: Optional[Context] = None) -> Hierarchy:
        """Reads a .sphm file that save() wrote."""
        context = context or default_context()
        pointer = context.make(lib.sph_io_load_hierarchy, context._handle.pointer, encoded(path))
        return cls._own(context, pointer, lib.sph_hierarchy_destroy)

    def save(self, path: PathLike) -> None:
        """Writes a .sphm file."""
        self.context.run(lib.sph_io_save_hierarchy, self.context._handle.pointer, self._pointer, encoded(path))

    @classmethod
    def from_bytes(cls, data: bytes, *, context: Optional[Context] = None) -> Hierarchy:
        """What to_bytes() wrote, or the content of a .sphm file."""
        context = context or default_context()
        held = np.frombuffer(data, np.uint8)
        pointer = context.make(lib.sph_hierarchy_read, context._handle.pointer, address(held), len(held))
        return cls._own(context, pointer, lib.sph_hierarchy_destroy)

    def to_bytes(self) -> bytes:
        """The hierarchy as save() writes it."""
        return written(self.context, lib.sph_hierarchy_write, self._pointer)

    @property
    def vertex_count(self) -> int:
        """n: vertices of the input, spheres of the finest level."""
        return int(lib.sph_hierarchy_vertex_count(self._pointer))

    @property
    def frame_count(self) -> int:
        """F"""
        return int(lib.sph_hierarchy_frame_count(self._pointer))

    @property
    def collapse_count(self) -> int:
        """C: the coarsest level has n - C spheres."""
        return int(lib.sph_hierarchy_collapse_count(self._pointer))

    @property
    def least_count(self) -> int:
        """n - C: spheres of the coarsest level."""
        return self.vertex_count - self.collapse_count

    @property
    def bounding_diagonal(self) -> float:
        """Mean over frames of the diagonal of the input's bounding box."""
        return float(lib.sph_hierarchy_bounding_diagonal(self._pointer))

    @property
    def evaluation_count(self) -> int:
        """Edge costs that were evaluated while building; 0 where it was loaded."""
        return int(lib.sph_hierarchy_evaluation_count(self._pointer))

    @property
    def first_forced(self) -> int:
        """The first collapse that inverts triangles; C where none does."""
        return int(lib.sph_hierarchy_first_forced(self._pointer))

    def collapses(self, first: int = 0, count: Optional[int] = None) -> NDArray[Any]:
        """The collapses in order: an array of COLLAPSE, with fields u, v, node, forced, cost and error."""
        out = np.empty(self.collapse_count - first if count is None else count, COLLAPSE)
        self.context.check(lib.sph_hierarchy_read_collapses(self._pointer, first, len(out),
                                                            struct_at(_abi.sph_collapse, out)))
        return out

    def sphere(self, node: int) -> Tuple[Floats, Floats]:
        """Centres, shape (F, 3), and radii, shape (F,), of a node."""
        centers, radii = np.empty((self.frame_count, 3), np.float32), np.empty(self.frame_count, np.float32)
        self.context.check(lib.sph_hierarchy_sphere(self._pointer, node, address(centers), address(radii)))
        return centers, radii

    def count_for_error(self, error: float) -> int:
        """Spheres of the coarsest level whose error is at most `error` (model units)."""
        out = ctypes.c_uint32()
        self.context.check(lib.sph_hierarchy_count_for_error(self._pointer, error, ctypes.byref(out)))
        return out.value

    def error_for_count(self, sphere_count: int) -> float:
        """Error of the level with so many spheres (model units), as in collapses(); 0 for the finest."""
        done = self.vertex_count - sphere_count
        return float(self.collapses(done - 1, 1)["error"][0]) if done else 0.0

    def level(self, sphere_count: Optional[int] = None, *, error: Optional[float] = None, first_frame: int = 0,
              frame_count: int = 0, labels: bool = True) -> Level:
        """One level of detail.

        Args:
            sphere_count: from least_count to n.
            error: instead: the coarsest level whose error is at most this (model units).
            first_frame, frame_count: some of the frames; 0: all from first_frame on.
            labels: whether the level says of every input vertex which sphere holds it. Without, the time does not grow
                with the input.
        """
        if (sphere_count is None) == (error is None):
            raise TypeError("level() takes either a number of spheres or an error")
        if sphere_count is None:
            assert error is not None
            sphere_count = self.count_for_error(error)
        how = options(_abi.sph_level_options, first_frame=first_frame, frame_count=frame_count,
                      labels=_abi.SPH_LABELS_VERTICES if labels else _abi.SPH_LABELS_NONE)
        pointer = self.context.make(lib.sph_level_extract, self._pointer, sphere_count, ctypes.byref(how))
        return Level._own(self.context, pointer, lib.sph_level_destroy)

    def cursor(self) -> Cursor:
        """A cursor at the finest level."""
        return Cursor(self)


class Cursor(Owned):
    """A place in a hierarchy: moving it takes time in proportion to what changes."""

    def __init__(self, hierarchy: Hierarchy):
        self.context = hierarchy.context
        pointer = self.context.make(lib.sph_cursor_create, hierarchy._pointer)
        self._handle = Handle(pointer, lib.sph_cursor_destroy, hierarchy._held)

    def move(self, sphere_count: int) -> Cursor:
        """Goes to the level of so many spheres; returns itself."""
        self.context.check(lib.sph_cursor_move(self._pointer, sphere_count))
        return self

    @property
    def sphere_count(self) -> int:
        """Spheres of the level where the cursor is."""
        return int(lib.sph_cursor_sphere_count(self._pointer))

    def read(self) -> Tuple[Indices, Indices, Indices]:
        """Nodes, shape (K,), wire edges, shape (e, 2), and triangles, shape (m, 3), all as node numbers."""
        nodes = filled(None, np.uint32, self.sphere_count)
        edges = filled(None, np.uint32, lib.sph_cursor_edge_count(self._pointer), 2)
        triangles = filled(None, np.uint32, lib.sph_cursor_triangle_count(self._pointer), 3)
        self.context.check(lib.sph_cursor_read(self._pointer, address(nodes), address(edges), address(triangles)))
        return nodes, edges, triangles
