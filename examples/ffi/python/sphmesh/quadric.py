# SPDX-License-Identifier: MIT
"""The spherical quadric error of animated planes, and the animated sphere that minimises it."""
from __future__ import annotations

import ctypes
from typing import NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike

from . import _abi
from ._arrays import Doubles, address, tight
from ._calls import Context, Handle, Owned, default_context
from ._library import lib


class Minimum(NamedTuple):
    """An animated sphere of least cost."""

    centers: Doubles  #: shape (F, 3)
    radius: float
    cost: float
    segment: float  #: where on the segments from u to v the frames lie whose planes do not fix a centre
    degenerate_frames: int  #: how many such frames there are


class Quadric(Owned):
    """A sum of planes, weight (n.(p - q) - r)^2 each, in every one of F frames; at first none."""

    def __init__(self, frame_count: int, *, context: Optional[Context] = None):
        self.context = context or default_context()
        pointer = self.context.make(lib.sph_quadric_create, self.context._handle.pointer, frame_count)
        self._handle = Handle(pointer, lib.sph_quadric_destroy, self.context._handle)

    @property
    def frame_count(self) -> int:
        """F"""
        return int(lib.sph_quadric_frame_count(self._pointer))

    def add_plane(self, frame: int, point: ArrayLike, normal: ArrayLike, weight: float = 1) -> None:
        """Adds a plane, by any point of it and its outward normal, to one frame."""
        p, n = tight(point, np.float64, 3), tight(normal, np.float64, 3)
        self.context.check(lib.sph_quadric_add_plane(self._pointer, frame, address(p), address(n), weight))

    def add_attachment(self, frame: int, center: ArrayLike, weight: float = 1) -> None:
        """Adds weight |q - center|^2 to one frame."""
        c = tight(center, np.float64, 3)
        self.context.check(lib.sph_quadric_add_attachment(self._pointer, frame, address(c), weight))

    def __iadd__(self, other: Quadric) -> Quadric:
        self.context.check(lib.sph_quadric_add(self._pointer, other._pointer))
        return self

    def evaluate(self, centers: ArrayLike, radius: float) -> float:
        """The cost of an animated sphere: centres of shape (F, 3)."""
        places, out = tight(centers, np.float64, self.frame_count, 3), ctypes.c_double()
        self.context.check(lib.sph_quadric_evaluate(self._pointer, address(places), radius, ctypes.byref(out)))
        return out.value

    def minimize(self, radius_max: float = np.inf, u: Optional[ArrayLike] = None,
                 v: Optional[ArrayLike] = None) -> Minimum:
        """The animated sphere of least cost with a radius from 0 to radius_max.

        Args:
            u, v: shape (F, 3): the segments on which centres lie that the planes do not fix; the origin if not given.
        """
        count = self.frame_count
        ends = [None if a is None else tight(a, np.float64, count, 3) for a in (u, v)]
        out, centers = _abi.sph_quadric_minimum(), np.empty((count, 3))
        self.context.check(lib.sph_quadric_minimize(self._pointer, address(ends[0]), address(ends[1]), radius_max,
                                                    ctypes.byref(out), address(centers)))
        return Minimum(centers, out.radius, out.cost, getattr(out, "lambda"), out.degenerate_frames)
