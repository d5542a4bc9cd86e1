# SPDX-License-Identifier: MIT
"""Distances between an animated mesh (1) and the outer surface of a level, or another mesh (2)."""
from __future__ import annotations

import ctypes
from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

from . import _abi
from ._arrays import DISTANCES, struct_at
from ._calls import Progress, Record, options
from ._library import lib
from .animation import Animation
from .level import Level


class Measurement(NamedTuple):
    """Distances: `mean` over the frames that were measured, and `frames`, an array of DISTANCES.

    Fields of either: hausdorff, mean12, mean21, max12, max21 in model units, area1, area2.
    """

    mean: Record
    frames: NDArray[Any]


def _measure(function: Any, animation: Animation, other: Any, samples: int, seed: int, first_frame: int,
             frame_step: int, frame_limit: int, progress: Optional[Progress]) -> Measurement:
    how = options(_abi.sph_measure_options, samples=samples, seed=seed, first_frame=first_frame, frame_step=frame_step,
                  frame_limit=frame_limit)
    count = len(range(first_frame, animation.frame_count, max(frame_step, 1)))
    out, mean = np.zeros(min(count, frame_limit) if frame_limit else count, DISTANCES), _abi.sph_distances()
    animation.context.run(function, animation._pointer, other._pointer, ctypes.byref(how), ctypes.byref(mean),
                          struct_at(_abi.sph_distances, out), progress=progress)
    return Measurement(Record(mean), out)


def measure_level(animation: Animation, level: Level, *, samples: int = 10000, seed: int = 1, first_frame: int = 0,
                  frame_step: int = 1, frame_limit: int = 0, progress: Optional[Progress] = None) -> Measurement:
    """Measures a level against the animation that it approximates.

    Args:
        samples: points per surface and frame.
        seed: of the points.
        first_frame, frame_step, frame_limit: which frames; frame_limit 0: all.
    """
    return _measure(lib.sph_measure_level, animation, level, samples, seed, first_frame, frame_step, frame_limit,
                    progress)


def measure_meshes(first: Animation, second: Animation, *, samples: int = 10000, seed: int = 1, first_frame: int = 0,
                   frame_step: int = 1, frame_limit: int = 0, progress: Optional[Progress] = None) -> Measurement:
    """Measures two animated meshes of as many frames against each other: see measure_level()."""
    return _measure(lib.sph_measure_meshes, first, second, samples, seed, first_frame, frame_step, frame_limit,
                    progress)
