# SPDX-License-Identifier: MIT
"""Levels of detail of skinned meshes: fewer vertices, on the same bones."""
from __future__ import annotations

import ctypes
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _abi
from ._arrays import Floats, Indices, address, indices, tight
from ._calls import Context, Handle, Owned, Progress, Record, choice, default_context, options, sized
from ._library import lib
from .animation import PathLike, encoded
from .hierarchy import Cursor
from .rig import Rig
from .skin import Skin, nothing, open_rig_options, rows


class Attributes(NamedTuple):
    """What belongs to the vertices and triangles of a level, in the order of its skin."""

    normals: Floats  #: shape (n, 3); zeros where none were given
    values: Floats  #: shape (n, C): texture coordinates, colours, whatever was given
    vertex_sources: Indices  #: shape (n,): an input vertex that each comes from
    triangle_sources: Indices  #: shape (m,): the input triangle that each is


class Progressive(Owned):
    """All levels of a skinned mesh, named by their number of collapses: 0 is the input.

    Args:
        skin: with triangles; read during the call only.
        method: "skinned": the error of all poses, positions and weights are optimised; "position", "pulled_back", "rest":
            simpler ways, see SPH_SIMPLIFY_* of the headers.
        influences: most bones per vertex; 0: as many as the skin has.
        poses: shape (P, J, 3, 4): example poses; frames of the skin if not given.
        pose_limit: at most so many of these frames; 0: all.
        border_weight: how heavy borders and seams are.
        tolerance, rounds: when the minimisation of an edge ends.
        attributes: shape (n, C): texture coordinates and the like, blended along.
        normals: shape (n, 3).
        groups: shape (n,): vertices of different groups stay apart.
        locked: shape (n,): True where a vertex stays in all levels.
    """

    def __init__(self, skin: Skin, *, method: str = "skinned", influences: int = 0, poses: Optional[ArrayLike] = None,
                 pose_limit: Optional[int] = None, border_weight: Optional[float] = None,
                 tolerance: Optional[float] = None, rounds: Optional[int] = None, attributes: Optional[ArrayLike] = None,
                 normals: Optional[ArrayLike] = None, groups: Optional[ArrayLike] = None,
                 locked: Optional[ArrayLike] = None, progress: Optional[Progress] = None):
        how, keep = simplify_options(skin.vertex_count, skin.bone_count, method, influences, poses, pose_limit,
                                     border_weight, tolerance, rounds, attributes, normals, groups, locked)
        self.context = skin.context
        pointer = self.context.make(lib.sph_progressive_create, skin._pointer, ctypes.byref(how), progress=progress)
        self._handle = Handle(pointer, lib.sph_progressive_destroy, self.context._handle)
        del keep

    @property
    def collapse_count(self) -> int:
        """C: levels are 0 to C."""
        return int(lib.sph_progressive_collapse_count(self._pointer))

    @property
    def point_count(self) -> int:
        """Places that the vertices of the input share: the finest level's points."""
        return int(lib.sph_progressive_point_count(self._pointer))

    @property
    def pose_count(self) -> int:
        """Example poses that the error is summed over."""
        return int(lib.sph_progressive_pose_count(self._pointer))

    @property
    def bounding_diagonal(self) -> float:
        """Mean over the example poses of the diagonal of the input's bounding box."""
        return float(lib.sph_progressive_bounding_diagonal(self._pointer))

    @property
    def attribute_count(self) -> int:
        """C of the attributes."""
        return int(lib.sph_progressive_attribute_count(self._pointer))

    def find(self, *, vertices: Optional[int] = None, triangles: Optional[int] = None,
             error: Optional[float] = None) -> int:
        """The finest level of at most so many vertices or triangles, or the coarsest of at most such an error."""
        wanted = [(function, value) for function, value in (
            (lib.sph_progressive_find_vertices, vertices), (lib.sph_progressive_find_triangles, triangles),
            (lib.sph_progressive_find_error, error)) if value is not None]
        if len(wanted) != 1:
            raise TypeError("a number of vertices, of triangles, or an error is needed")
        (function, value), out = wanted[0], ctypes.c_uint32()
        self.context.check(function(self._pointer, value, ctypes.byref(out)))
        return out.value

    def describe(self, level: int) -> Record:
        """A level in figures: `vertex_count`, `point_count`, `triangle_count`, `forced`, `error` and `max_error`."""
        out = sized(_abi.sph_progressive_level)
        self.context.check(lib.sph_progressive_get_level(self._pointer, level, ctypes.byref(out)))
        return Record(out)

    def skin(self, level: Optional[int] = None, **wanted: Any) -> Skin:
        """A level as a skin, by its number or as find() takes it: `progressive.skin(triangles=1000)`."""
        pointer = self.context.make(lib.sph_progressive_get_skin, self._pointer,
                                    self.find(**wanted) if level is None else level)
        return Skin._own(self.context, pointer, lib.sph_skin_destroy)

    def attributes(self, level: int) -> Attributes:
        """Normals, attributes, and where vertices and triangles of a level come from."""
        told = self.describe(level)
        out = Attributes(np.empty((told.vertex_count, 3), np.float32),
                         np.empty((told.vertex_count, self.attribute_count), np.float32),
                         np.empty(told.vertex_count, np.uint32), np.empty(told.triangle_count, np.uint32))
        self.context.check(lib.sph_progressive_get_attributes(self._pointer, level, *[address(a) for a in out]))
        return out

    def cursor(self) -> Cursor:
        """A cursor over the points of the levels, without seams: it moves to a number of points."""
        pointer = self.context.make(lib.sph_progressive_create_cursor, self._pointer)
        return Cursor._own(self.context, pointer, lib.sph_cursor_destroy, self._held)

    def point(self, number: int) -> Tuple[Floats, Indices, Floats]:
        """Rest position, bones and weights of a point of any level, as cursors name them."""
        slots = lib.sph_progressive_influence_count(self._pointer)
        rest, bones, weights = np.empty(3, np.float32), np.empty(slots, np.uint32), np.empty(slots, np.float32)
        self.context.check(lib.sph_progressive_point(self._pointer, number, address(rest), address(bones),
                                                     address(weights)))
        return rest, bones, weights


class RigLevels(Owned):
    """All levels of the rigged meshes of a glTF, which are saved with all else that the file has.

    Args:
        path: the glTF.
        clip, fps, first_frame, end_frame, frame_step: the frames that are example poses, as Skin.open() has them.
        simplify: what Progressive takes, but normals, attributes and groups: they are the file's.
    """

    def __init__(self, path: PathLike, *, clip: Optional[str] = None, fps: float = 0, first_frame: int = 0,
                 end_frame: int = 0, frame_step: int = 1, context: Optional[Context] = None,
                 progress: Optional[Progress] = None, method: str = "skinned", influences: int = 0,
                 pose_limit: Optional[int] = None, border_weight: Optional[float] = None,
                 tolerance: Optional[float] = None, rounds: Optional[int] = None):
        self.context = context or default_context()
        rig = open_rig_options(clip, fps, first_frame, end_frame, frame_step)
        how, keep = simplify_options(-1, -1, method, influences, None, pose_limit, border_weight, tolerance, rounds)
        pointer = self.context.make(lib.sph_io_open_rig_levels, self.context._handle.pointer, encoded(path),
                                    ctypes.byref(rig), ctypes.byref(how), progress=progress)
        self._handle = Handle(pointer, lib.sph_io_rig_levels_destroy, self.context._handle)

    @property
    def progressive(self) -> Progressive:
        """The levels."""
        return Progressive._own(self.context, lib.sph_io_rig_levels_progressive(self._pointer), nothing, self._held)

    @property
    def rig(self) -> Rig:
        """The file's rig as it is read."""
        return Rig._own(self.context, lib.sph_io_rig_levels_rig(self._pointer), nothing, self._held)

    def save(self, path: PathLike, levels: Sequence[int]) -> None:
        """Writes the file as .glb with its meshes at a level, or at several, finest first (MSFT_lod)."""
        chosen = tight(levels, np.uint32, -1)
        self.context.run(lib.sph_io_rig_levels_save, self._pointer, address(chosen), len(chosen), encoded(path))


def simplify_options(vertices: int, bones: int, method: str, influences: int, poses: Optional[ArrayLike],
                     pose_limit: Optional[int], border_weight: Optional[float], tolerance: Optional[float],
                     rounds: Optional[int], attributes: Optional[ArrayLike] = None, normals: Optional[ArrayLike] = None,
                     groups: Optional[ArrayLike] = None, locked: Optional[ArrayLike] = None) -> Tuple[Any, List[Any]]:
    """sph_simplify_options, and the arrays that they need to be there."""
    how = options(_abi.sph_simplify_options, method=choice("SPH_SIMPLIFY_", method), influence_limit=influences,
                  pose_limit=pose_limit, border_weight=border_weight, tolerance=tolerance, round_limit=rounds)
    keep: List[Any] = []

    def give(name: str, values: Optional[ArrayLike], kind: Any, *shape: int) -> Optional[NDArray[Any]]:
        if values is None:
            return None
        keep.append(tight(values, kind, *shape))
        setattr(how, name, address(keep[-1]))
        return keep[-1]  # type: ignore[no-any-return]

    examples = give("poses", None if poses is None else rows(poses, 4), np.float64, -1, bones, 3, 4)
    how.pose_count = 0 if examples is None else len(examples)
    columns = give("attributes", attributes, np.float32, vertices, -1)
    how.attribute_count = 0 if columns is None else columns.shape[1]
    give("normals", normals, np.float32, vertices, 3)
    give("groups", None if groups is None else indices(np.reshape(groups, (-1, 1)), 1)[:, 0], np.uint32, vertices)
    give("locked", None if locked is None else np.asarray(locked, np.bool_), np.bool_, vertices)
    return how, keep
