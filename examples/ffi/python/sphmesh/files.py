# SPDX-License-Identifier: MIT
"""What files hold, and memory that lives in one."""
from __future__ import annotations

import ctypes
from typing import Optional, Union

from . import _abi
from ._calls import Context, Handle, Progress, Record, default_context, options, sized
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
