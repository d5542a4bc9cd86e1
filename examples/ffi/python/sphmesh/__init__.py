# SPDX-License-Identifier: MIT
"""Animated meshes as hierarchies of animated sphere-meshes: Python over libsphmesh and libsphmesh-io.

    import sphmesh
    animation = sphmesh.Animation(frames, triangles)      # float32 (F, n, 3), not copied, and (m, 3)
    level = animation.build().level(40)                   # 40 animated spheres, edges and triangles between them
    hits = level.query(frame=2.5).cast(starts, ends)      # an array: hits["hit"], hits["s"], hits["contact"]["point"]

Objects give their memory back when nobody refers to them any more, or by close() or a `with` block. Arrays of an object
are read-only views of the library's memory, which they keep alive. What fails raises a SphmeshError of its own kind.
Python's lock is free while the library works, and Ctrl-C cancels it.
"""
from ._abi import SPH_NO_JOINT as NO_JOINT
from ._abi import SPH_NO_SPHERE as NO_SPHERE
from ._arrays import COLLAPSE, CONTACT, DISTANCES, HIT, NEAREST, SKIN_ERROR, SWEEP, TRACKER_REPORT
from ._calls import Context, Record, default_context
from ._library import lib
from .animation import Animation, open_animation
from .errors import (CancelledError, FormatError, InputOutputError, InvalidError, LimitError, OutOfMemoryError,
                     SphmeshError, StateError, UnsupportedError, VersionError)
from .files import SpillingContext, clips, describe, load, objects, save_frames, save_mesh
from .hierarchy import Cursor, Hierarchy
from .implicit import NO_BONE, Curve, Field, Implicit, Joint, Part, TrackedPose, Tracker, compose, intersections
from .level import Level
from .measure import Measurement, measure_level, measure_meshes
from .pose import Deformer, Pose, Skeleton
from .quadric import Minimum, Quadric
from .query import Query, sweeps
from .rig import Rig
from .simplify import Attributes, Progressive, RigLevels
from .skin import Clip, Skin
from .surface import Mesh, Surface

__version__ = "0.1.0"


def library_version() -> int:
    """Version of the library that runs: major * 1000000 + minor * 1000 + patch."""
    return int(lib.sph_version())


__all__ = [name for name in dir() if not name.startswith("_") and name not in ("lib",)]
