# SPDX-License-Identifier: MIT
"""What files hold, and memory that lives in one."""
from __future__ import annotations

import ctypes
from typing import Any, Callable, List, Optional, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _abi
from ._arrays import address, indices, tight
from ._calls import Context, Handle, Progress, Record, default_context, options, report, sized
from ._library import lib
from .animation import PathLike, encoded
from .hierarchy import Hierarchy
from .implicit import Implicit
from .level import Level


def load(path: PathLike, *, context: Optional[Context] = None) -> Union[Hierarchy, Level, Implicit]:
    """Reads a .sphm file, whatever it holds, or the .json of a level."""
    context = context or default_context()
    if encoded(path).lower().endswith(b".json"):
        return Level.load(path, context=context)
    kind = ctypes.c_int32()
    context.run(lib.sph_io_identify, context._handle.pointer, encoded(path), ctypes.byref(kind))
    if kind.value == _abi.SPH_IO_HIERARCHY:
        return Hierarchy.load(path, context=context)
    if kind.value == _abi.SPH_IO_IMPLICIT:
        return Implicit.load(path, context=context)
    return Level.load(path, context=context)


def describe(path: PathLike, *, context: Optional[Context] = None) -> Record:
    """What a file is, or those that a pattern stands for: `format`, `file_count`, `point_count`, `frame_count`."""
    context = context or default_context()
    out = sized(_abi.sph_io_description)
    context.run(lib.sph_io_describe, context._handle.pointer, encoded(path), ctypes.byref(out))
    return Record(out)


def clips(path: PathLike, *, fps: float = 0, context: Optional[Context] = None) -> List[Record]:
    """The clips of a glTF: `name`, `duration` in seconds, and `frame_count` at so many frames per second; 0: 30."""
    context = context or default_context()
    told: List[Record] = []
    context.run(lib.sph_io_list_clips, context._handle.pointer, encoded(path), fps,
                _abi.sph_io_clip_fn(_noting(_abi.sph_io_clip, told)), None)
    return told


def objects(path: PathLike, *, object: Optional[str] = None,
            context: Optional[Context] = None) -> Tuple[Optional[Record], List[Record]]:
    """What an Alembic says of itself, and its objects: `path`, `kind`, `vertex_count`, `chosen`, `hidden`, ...

    Args:
        object: which are chosen, as in open_animation().
    """
    context = context or default_context()
    archives: List[Record] = []
    told: List[Record] = []
    context.run(lib.sph_io_list_objects, context._handle.pointer, encoded(path),
                None if object is None else object.encode(),
                _abi.sph_io_archive_fn(_noting(_abi.sph_io_archive, archives)),
                _abi.sph_io_object_fn(_noting(_abi.sph_io_object, told)), None)
    return archives[0] if archives else None, told


def _noting(struct: Any, told: List[Record]) -> Callable[[Optional[int], Any], None]:
    """A callback that keeps what it is told."""

    def take(user: Optional[int], pointer: Any) -> None:
        try:
            told.append(Record(pointer.contents))
        except BaseException as error:
            report(error)

    return take


def save_mesh(path: PathLike, positions: ArrayLike, triangles: ArrayLike, normals: Optional[ArrayLike] = None, *,
              context: Optional[Context] = None) -> None:
    """Writes a mesh as .obj, or .ply (binary)."""
    context = context or default_context()
    points, faces = tight(positions, np.float32, -1, 3), indices(triangles, 3)
    ways = None if normals is None else tight(normals, np.float32, len(points), 3)
    context.run(lib.sph_io_save_mesh, context._handle.pointer, len(points), address(points), address(ways), len(faces),
                address(faces), encoded(path))


def save_frames(path: PathLike, frames: ArrayLike, triangles: ArrayLike, *, fps: float = 30, name: str = "",
                context: Optional[Context] = None) -> None:
    """Writes frames, shape (F, n, 3), as a .glb of morph targets that any viewer of glTF plays."""
    context = context or default_context()
    points, faces = np.ascontiguousarray(frames, np.float32), indices(triangles, 3)
    if points.ndim != 3 or points.shape[2] != 3:
        raise ValueError(f"frames: shape {points.shape} is not (F, n, 3)")
    how = sized(_abi.sph_io_frames)
    how.frame_count, how.vertex_count = points.shape[:2]
    how.positions, how.triangles, how.triangle_count = address(points), address(faces), len(faces)
    how.frames_per_second, how.name = fps, name.encode()
    context.run(lib.sph_io_save_frames_glb, context._handle.pointer, ctypes.byref(how), encoded(path))


class SpillingContext(Context):
    """A context for data that does not fit into memory: large blocks live in a temporary file.

    Args:
        resident: bytes that the process should have in memory at most; at least 16 MiB.
        folder: where the file goes, on a disk.
    """

    def __init__(self, resident: int, folder: Optional[PathLike] = None, *, threads: int = 0,
                 progress: Optional[Progress] = None):
        self.progress = progress
        plain = Context(threads=threads)
        how = options(_abi.sph_io_spill_options, memory_limit=resident,
                      folder=None if folder is None else encoded(folder))
        pointer = plain.make(lib.sph_io_spill_create, plain._handle.pointer, ctypes.byref(how))
        self._spill = Handle(pointer, lib.sph_io_spill_destroy, plain._handle)
        made = options(_abi.sph_context_options)
        lib.sph_io_spill_get_allocator(pointer, ctypes.byref(made.allocator))
        lib.sph_io_spill_get_executor(pointer, ctypes.byref(made.executor))
        self._make(made, self._spill)

    @property
    def figures(self) -> Record:
        """What lives in the file: `live_bytes`, `peak_live_bytes`, `file_bytes`, `resident_bytes`, `trims`."""
        out = sized(_abi.sph_io_spill_figures)
        self.check(lib.sph_io_spill_get_figures(self._spill.pointer, ctypes.byref(out)))
        return Record(out)

    def trim(self) -> None:
        """Looks at the memory now, and takes pages away where it is near the limit; it does so by itself, too."""
        lib.sph_io_spill_trim(self._spill.pointer)
