# SPDX-License-Identifier: MIT
"""Animated meshes: F frames of n vertices with one connectivity."""
from __future__ import annotations

import ctypes
import os
from typing import TYPE_CHECKING, Any, Callable, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _abi
from ._arrays import Floats, Indices, address, filled, indices, lent, tight
from ._calls import Context, Handle, Owned, Progress, Record, choice, default_context, options, report
from ._library import lib

if TYPE_CHECKING:
    from .hierarchy import Hierarchy

PathLike = Union[str, "os.PathLike[str]"]
ReadFrame = Callable[[int, Floats], Any]


def encoded(path: PathLike) -> bytes:
    return os.fsencode(os.fspath(path))


class Animation(Owned):
    """An animated mesh.

    Args:
        frames: shape (F, n, 3), or (n, 3) for one frame. An array of float32 whose vertices are adjacent is not copied:
            the animation reads it whenever it needs a frame, so leave it as it is for as long.
        triangles: shape (m, 3), vertex indices; counter-clockwise seen from outside.
        edges: shape (e, 2): edges of no triangle, such as wires.

    Raises:
        InvalidError: an index is out of range. Positions are looked at by the calls that use them.
    """

    def __init__(self, frames: ArrayLike, triangles: Optional[ArrayLike] = None, edges: Optional[ArrayLike] = None, *,
                 context: Optional[Context] = None):
        array = np.asarray(frames, np.float32)
        if array.ndim == 2:
            array = array[np.newaxis]
        if array.ndim != 3 or array.shape[2] != 3:
            raise ValueError(f"frames of shape {array.shape} where (F, n, 3) is needed")
        step, row, item = array.strides
        if not array.flags.aligned or item != 4 or row < 12 or step <= 0 or step % 4 or row % 4:
            array = np.require(array, np.float32, ["C", "ALIGNED"])
            step, row, item = array.strides
        self.context = context or default_context()
        pointer = self.context.make(lib.sph_animation_create_from_positions, self.context._handle.pointer, array.shape[1], array.shape[0],
                                    address(array), row, step)
        self._handle = Handle(pointer, lib.sph_animation_destroy, self.context._handle, array)
        self._set_topology(triangles, edges)

    def _set_topology(self, triangles: Optional[ArrayLike], edges: Optional[ArrayLike]) -> None:
        for rows, corners, setter in ((triangles, 3, lib.sph_animation_set_triangles),
                                      (edges, 2, lib.sph_animation_set_edges)):
            if rows is not None:
                array = indices(rows, corners)
                self.context.check(setter(self._pointer, address(array), len(array), 0))

    @classmethod
    def from_source(cls, read_frame: ReadFrame, vertex_count: int, frame_count: int,
                    triangles: Optional[ArrayLike] = None, edges: Optional[ArrayLike] = None, *,
                    context: Optional[Context] = None) -> Animation:
        """An animation whose frames a function of yours provides, one at a time and as often as they are needed.

        Args:
            read_frame: read_frame(frame, xyz) writes the positions of a frame to `xyz`, a float32 array of shape (n, 3)
                that is there during the call only; or it returns positions, which are then copied there. What it raises
                comes out of the call that asked for the frame.
        """
        context = context or default_context()
        size = 12 * vertex_count

        def read(user: Optional[int], frame: int, xyz: int) -> int:
            try:
                memory = memoryview((ctypes.c_char * size).from_address(xyz))
                to = np.frombuffer(memory, np.float32).reshape(vertex_count, 3)
                given = read_frame(frame, to)
                if given is not None and given is not to:
                    to[...] = tight(given, np.float32, vertex_count, 3)
            except BaseException as error:
                report(error)
                return _abi.SPH_E_CANCELLED
            return _abi.SPH_OK

        source = _abi.sph_frame_source()
        source.read_frame = type(source.read_frame)(read)
        pointer = context.make(lib.sph_animation_create_from_source, context._handle.pointer, vertex_count, frame_count, ctypes.byref(source))
        made = cls._own(context, pointer, lib.sph_animation_destroy, source)
        made._set_topology(triangles, edges)
        return made

    @property
    def vertex_count(self) -> int:
        """n"""
        return int(lib.sph_animation_vertex_count(self._pointer))

    @property
    def frame_count(self) -> int:
        """F"""
        return int(lib.sph_animation_frame_count(self._pointer))

    @property
    def triangles(self) -> Indices:
        """Shape (m, 3), read-only, not copied."""
        count = lib.sph_animation_triangle_count(self._pointer)
        return lent(self._held, lib.sph_animation_triangles(self._pointer), (count, 3), np.uint32)

    @property
    def edges(self) -> Indices:
        """Shape (e, 2), read-only, not copied: the edges that were given besides the triangles."""
        count = lib.sph_animation_edge_count(self._pointer)
        return lent(self._held, lib.sph_animation_edges(self._pointer), (count, 2), np.uint32)

    def read_frame(self, frame: int, out: Optional[Floats] = None) -> Floats:
        """The positions of a frame, shape (n, 3); written to `out` if it is given."""
        out = filled(out, np.float32, self.vertex_count, 3)
        self.context.run(lib.sph_animation_read_frame, self._pointer, frame, address(out))
        return out

    def bounding_diagonal(self) -> float:
        """Mean over the frames of the diagonal of the bounding box."""
        out = ctypes.c_double()
        self.context.run(lib.sph_animation_bounding_diagonal, self._pointer, ctypes.byref(out))
        return out.value

    def check(self, *, progress: Optional[Progress] = None) -> Record:
        """What is wrong with the input, if anything: the fields of sph_animation_report, such as `non_finite_count`."""
        out = options(_abi.sph_animation_report)
        self.context.run(lib.sph_animation_check, self._pointer, ctypes.byref(out), progress=progress)
        return Record(out)

    def weld(self, tolerance: float = 0, *, progress: Optional[Progress] = None) -> Tuple[Animation, Indices]:
        """A new animation in which vertices that coincide in all frames are one, and each old vertex's new index."""
        renumbered = np.empty(self.vertex_count, np.uint32)
        pointer = self.context.make(lib.sph_animation_weld, self._pointer, tolerance, address(renumbered),
                                    progress=progress)
        return self._own(self.context, pointer, lib.sph_animation_destroy), renumbered

    def build(self, **how: Any) -> Hierarchy:
        """The hierarchy of sphere-meshes: see Hierarchy.build()."""
        from .hierarchy import Hierarchy

        return Hierarchy.build(self, **how)

    def save(self, obj_path: PathLike, cache_path: PathLike, *, frames_per_second: float = 30,
             progress: Optional[Progress] = None) -> None:
        """Writes frame 0 as OBJ and all frames as a point cache beside it: .pc2 or .mdd."""
        obj, cache = encoded(obj_path), encoded(cache_path)
        if cache.lower().endswith(b".mdd"):
            self.context.run(lib.sph_io_save_obj_mdd, self.context._handle.pointer, self._pointer, 0, frames_per_second,
                             obj, cache, progress=progress)
        else:
            self.context.run(lib.sph_io_save_obj_pc2, self.context._handle.pointer, self._pointer, 0, 1, obj, cache,
                             progress=progress)


def open_animation(*paths: PathLike, cache: Optional[PathLike] = None, first_frame: int = 0, end_frame: int = 0,
                   frame_step: int = 1, up: str = "y", scale: float = 1, fps: float = 0, clip: Optional[str] = None,
                   weld: str = "auto", space: str = "local", object: Optional[str] = None,
                   progress: Optional[Progress] = None, context: Optional[Context] = None) -> Animation:
    """Reads an animation from files: a mesh with a point cache, a sequence of meshes, a glTF, an Alembic, or a mesh.

    Args:
        paths: one file, a glob or a printf pattern, or the files of a sequence.
        cache: PC2 or MDD point cache.
        first_frame, end_frame, frame_step: which frames; end_frame 0: to the end.
        up: "y", or "z" to turn positions so that y is up.
        scale: positions are multiplied by it.
        fps: frames per second that a glTF is baked, or an Alembic is taken at; 0: 30, and the samples.
        clip: the animation of a glTF, by name or number.
        weld: "auto", "none" or "all": whether vertices that coincide in all frames become one.
        space: "local" or "world", of an Alembic.
        object: of an Alembic, by path or name.

    Raises:
        InputOutputError, FormatError, UnsupportedError: the message names file and byte.
    """
    context = context or default_context()
    names = (ctypes.c_char_p * len(paths))(*[encoded(path) for path in paths])
    how = options(_abi.sph_io_open_options, cache_path=None if cache is None else encoded(cache),
                  first_frame=first_frame, end_frame=end_frame, frame_step=frame_step, up_axis=choice("SPH_UP_", up),
                  scale=scale, fps=fps, clip=None if clip is None else clip.encode(),
                  weld=choice("SPH_IO_WELD_", weld), space=choice("SPH_IO_SPACE_", space),
                  object=None if object is None else object.encode())
    pointer = context.make(lib.sph_io_open_animation, context._handle.pointer, names, len(paths), ctypes.byref(how),
                           progress=progress)
    return Animation._own(context, pointer, lib.sph_animation_destroy)


Animations = Union[Animation, Sequence[Animation]]
