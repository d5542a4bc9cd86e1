# SPDX-License-Identifier: MIT
"""The outer surface of a level as a closed triangle mesh."""
from __future__ import annotations

import ctypes
from typing import Iterator, NamedTuple, Optional

import numpy as np

from . import _abi
from ._arrays import Floats, Indices, lent
from ._calls import Handle, Owned, Progress, options
from ._library import lib
from .animation import PathLike, encoded
from .level import Level


class Mesh(NamedTuple):
    """One frame of a surface; arrays are read-only and not copied."""

    positions: Floats  #: shape (n, 3)
    normals: Floats  #: shape (n, 3), unit, outward
    triangles: Indices  #: shape (m, 3), counter-clockwise from outside


class Surface(Owned):
    """The outer surface of a level, of one frame or several: `surface[0]` is the Mesh of the first.

    Args:
        level: may be closed afterwards.
        resolution: cells along the longest side of the bounding box.
        first_frame, frame_step, frame_limit: which frames; frame_limit 0: all.
        memory_limit: bytes that may be held at once.
    """

    def __init__(self, level: Level, *, resolution: int = 128, first_frame: int = 0, frame_step: int = 1,
                 frame_limit: int = 0, memory_limit: Optional[int] = None, progress: Optional[Progress] = None):
        self.context = level.context
        how = options(_abi.sph_surface_options, resolution=resolution, first_frame=first_frame, frame_step=frame_step,
                      frame_limit=frame_limit, memory_limit=memory_limit)
        pointer = self.context.make(lib.sph_surface_create, level._pointer, ctypes.byref(how), progress=progress)
        self._handle = Handle(pointer, lib.sph_surface_destroy, self.context._handle)

    def __len__(self) -> int:
        return int(lib.sph_surface_frame_count(self._pointer))

    def __getitem__(self, index: int) -> Mesh:
        if not -len(self) <= index < len(self):
            raise IndexError(f"frame {index} of {len(self)}")
        index %= len(self)
        points = lib.sph_surface_vertex_count(self._pointer, index)
        faces = lib.sph_surface_triangle_count(self._pointer, index)
        return Mesh(lent(self._held, lib.sph_surface_positions(self._pointer, index), (points, 3), np.float32),
                    lent(self._held, lib.sph_surface_normals(self._pointer, index), (points, 3), np.float32),
                    lent(self._held, lib.sph_surface_triangles(self._pointer, index), (faces, 3), np.uint32))

    def __iter__(self) -> Iterator[Mesh]:
        return (self[i] for i in range(len(self)))

    @property
    def cell(self) -> float:
        """Side of a cell, model units."""
        return float(lib.sph_surface_cell(self._pointer))

    def save(self, path: PathLike, index: int = 0) -> None:
        """Writes one frame as .obj, .ply or .glb."""
        self.context.run(lib.sph_io_save_surface, self.context._handle.pointer, self._pointer, index, encoded(path))
