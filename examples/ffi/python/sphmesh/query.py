# SPDX-License-Identifier: MIT
"""What a posed level can be asked: casts, distances, containment, contact."""
from __future__ import annotations

import ctypes
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _abi
from ._arrays import HIT, NEAREST, SWEEP, address, filled, strided, struct_at, tight
from ._calls import Handle, Owned, Record, choice, options
from ._library import lib
from .level import Level


class Query(Owned):
    """A level in one pose. It has a copy of the level. Many threads may ask at once, while none moves it.

    Args:
        level: may be closed afterwards.
        frame: the first pose; between frames too, such as 2.25.
        search: "auto", "exhaustive" or "tree": how; the answers are the same.
    """

    def __init__(self, level: Level, frame: float = 0, *, search: str = "auto"):
        self.context = level.context
        how = options(_abi.sph_query_options, search=choice("SPH_SEARCH_", search))
        pointer = self.context.make(lib.sph_query_create, level._pointer, ctypes.byref(how))
        self._handle = Handle(pointer, lib.sph_query_destroy, self.context._handle)
        self._sphere_count = level.sphere_count
        if frame != 0:
            self.pose(frame)

    def pose(self, frame: float) -> Query:
        """Poses the level as in a frame, or between two: 2.25 is a quarter of the way from 2 to 3. Returns itself."""
        self.context.check(lib.sph_query_pose_time(self._pointer, frame))
        return self

    def pose_centers(self, centers: ArrayLike, radii: Optional[ArrayLike] = None) -> Query:
        """Poses the level on centres of yours, shape (K, 3), and radii, shape (K,); the level's if not given."""
        places, stride = strided(centers)
        if len(places) != self._sphere_count:
            raise ValueError(f"{len(places)} centres for {self._sphere_count} spheres")
        sizes = None if radii is None else tight(radii, np.float32, self._sphere_count)
        self.context.check(lib.sph_query_pose_centers(self._pointer, address(places), stride, address(sizes)))
        return self

    def cast(self, start: ArrayLike, end: ArrayLike, radius: ArrayLike = 0, *,
             out: Optional[NDArray[Any]] = None) -> NDArray[Any]:
        """The first contacts of moving spheres, or rays, with the level.

        Args:
            start, end: shape (n, 3), or (3,) for one.
            radius: one for all, or shape (n,); 0: rays.

        Returns:
            an array of HIT: `hit`, `s` (from start at 0 to end at 1), `depth`, and `contact` with point, normal, weights,
            spheres, simplex and kind.
        """
        return self.cast_sweeps(sweeps(start, end, radius), out=out)

    def cast_sweeps(self, moving: NDArray[Any], *, out: Optional[NDArray[Any]] = None) -> NDArray[Any]:
        """cast() of an array of SWEEP, without copies."""
        moving = tight(moving, SWEEP, -1)
        out = filled(out, HIT, len(moving))
        self.context.check(lib.sph_query_cast(self._pointer, struct_at(_abi.sph_sweep, moving), len(moving),
                                              struct_at(_abi.sph_hit, out)))
        return out

    def cast_any(self, start: ArrayLike, end: ArrayLike, radius: ArrayLike = 0) -> NDArray[np.bool_]:
        """Whether moving spheres, or rays, touch the level at all."""
        moving = sweeps(start, end, radius)
        out = np.empty(len(moving), np.bool_)
        self.context.check(lib.sph_query_cast_any(self._pointer, struct_at(_abi.sph_sweep, moving), len(moving),
                                                  address(out)))
        return out

    def nearest(self, points: ArrayLike, *, out: Optional[NDArray[Any]] = None) -> NDArray[Any]:
        """Signed distances of points, shape (n, 3), and the nearest places: an array of NEAREST."""
        array, stride = strided(points)
        out = filled(out, NEAREST, len(array))
        self.context.check(lib.sph_query_nearest(self._pointer, address(array), stride, len(array),
                                                 struct_at(_abi.sph_nearest, out)))
        return out

    def distance(self, points: ArrayLike) -> NDArray[np.float64]:
        """Signed distances of points alone: below 0 inside."""
        return self.nearest(points)["distance"]

    def contains(self, points: ArrayLike, *, cavities: str = "solid") -> NDArray[np.bool_]:
        """Whether points are inside. Cavities are "solid", so that inside a hollow character is inside, or "space"."""
        array, stride = strided(points)
        out = np.empty(len(array), np.bool_)
        self.context.run(lib.sph_query_contains, self._pointer, address(array), stride, len(array),
                         choice("SPH_CAVITY_", cavities), address(out))
        return out

    def between(self, other: Query) -> Record:
        """Distance to another posed level, or the deepest overlap: `distance`, `hit`, `first` and `second`."""
        out = _abi.sph_gap()
        self.context.check(lib.sph_query_between(self._pointer, other._pointer, ctypes.byref(out)))
        return Record(out)

    def cast_between(self, motion: ArrayLike, other: Query) -> Record:
        """The first contact of this level, moved along `motion`, with another: `s`, and what between() tells."""
        way = tight(motion, np.float32, 3)
        out = _abi.sph_gap()
        self.context.check(lib.sph_query_cast_between(self._pointer, address(way), other._pointer, ctypes.byref(out)))
        return Record(out)


def sweeps(start: ArrayLike, end: ArrayLike, radius: ArrayLike = 0) -> NDArray[Any]:
    """Moving spheres as an array of SWEEP."""
    first, last = np.atleast_2d(np.asarray(start, np.float32)), np.atleast_2d(np.asarray(end, np.float32))
    made = np.zeros(max(len(first), len(last)) if len(first) and len(last) else 0, SWEEP)
    made["from"], made["to"], made["radius"] = first, last, radius
    return made
