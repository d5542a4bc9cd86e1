# SPDX-License-Identifier: MIT
"""Implicit skinning: poses corrected by the solids of a skin's parts, so that joints keep volume and skin touches itself."""
from __future__ import annotations

import ctypes
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _abi
from ._arrays import TRACKER_REPORT, Doubles, Floats, Indices, address, filled, indices, lent, struct_at, tight
from ._calls import Context, Handle, Owned, Progress, choice, default_context, options, sized
from ._library import lib
from .animation import PathLike, encoded
from .hierarchy import written
from .skin import Skin, rows

Vector = Tuple[float, float, float]
OPERATIONS = {getattr(_abi, name): name[14:].lower() for name in vars(_abi) if name.startswith("SPH_OPERATION_")}
NO_BONE = 0xFFFFFFFF  #: of a vertex of no part, a bone that hangs on none, a point where all fields are 0


def three(values: Any) -> Vector:
    return values[0], values[1], values[2]


class Curve(NamedTuple):
    """How full an operator is at an angle between two fields' gradients: see sph_theta_curve of the headers."""

    angles: Vector  #: radians, rising, 0 to pi
    thetas: Vector  #: radians, 0 (fullest) to pi/4 (union)
    exponents: Tuple[float, float]

    @classmethod
    def preset(cls, operation: str) -> Curve:
        """The curve that goes with an operation: "union", "blend" or "bulge"."""
        made = _abi.sph_theta_curve()
        lib.sph_theta_curve_preset(ctypes.byref(made), choice("SPH_OPERATION_", operation))
        return cls._of(made)

    @classmethod
    def _of(cls, struct: Any) -> Curve:
        return cls(three(struct.angles), three(struct.thetas), (struct.exponents[0], struct.exponents[1]))

    def _struct(self) -> Any:
        made = _abi.sph_theta_curve()
        made.angles[:], made.thetas[:], made.exponents[:] = self.angles, self.thetas, self.exponents
        return made

    def at(self, angle: float) -> float:
        """theta at an angle."""
        return float(lib.sph_theta_curve_at(ctypes.byref(self._struct()), angle))


class Joint(NamedTuple):
    """Two bones whose fields are composed by an operator of their own."""

    bones: Tuple[int, int]
    position: Vector  #: in the rest pose
    operation: str = "union"  #: or "blend", "bulge"
    strength: float = 0  #: of the bulge
    curve: Optional[Curve] = None  #: the operation's own, if not given

    def _fill(self, made: Any) -> None:
        made.struct_size = ctypes.sizeof(made)
        made.operation, made.strength = choice("SPH_OPERATION_", self.operation), self.strength
        made.bones[:], made.position[:] = self.bones, self.position
        made.curve = (self.curve or Curve.preset(self.operation))._struct()


class Part(NamedTuple):
    """A bone's part of the mesh, and the samples that its field goes through."""

    vertex_count: int
    closing_count: int  #: of the samples, at their end: where the part is closed
    radius: float  #: the field falls from 1 to 0 between -radius and radius from the surface
    low: Vector  #: box beyond which the field is 0
    high: Vector
    samples: Doubles  #: shape (m, 3); none: the bone has no field
    normals: Doubles  #: shape (m, 3)


class Field(NamedTuple):
    """The composed field at points."""

    values: Doubles  #: shape (n,): 0 to 1, 1/2 on the surface
    gradients: Optional[Doubles]  #: shape (n, 3)
    bones: Indices  #: shape (n,): whose field is the largest; NO_BONE where all are 0


class TrackedPose(NamedTuple):
    """Corrected vertices: shape (n, 3) each, or (poses, n, 3); and an entry of TRACKER_REPORT for each pose."""

    positions: Floats
    normals: Optional[Floats]
    reports: NDArray[Any]


class Implicit(Owned):
    """The fields of a skin's parts, and how they are composed at joints: what an artist edits and saves.

    Args:
        skin: with triangles; may be closed afterwards.
        operation: of joints: "union", "blend" or "bulge".
        samples: of a part.
        table_size, operator_table_size: nodes of the grids along each axis.
        joint_gap: samples that are nearer to a joint than this part of the bone's length are left out.
        parents: shape (J,): the bone that each hangs on, or NO_BONE; if not given, bones are joined by the skin's links.
        parts: shape (n,): the bone whose part a vertex belongs to, or NO_BONE; that of its largest weight, if not given.
        joints: instead of those that would be found for the same bones.
    """

    def __init__(self, skin: Skin, *, operation: str = "union", samples: Optional[int] = None,
                 table_size: Optional[int] = None, operator_table_size: Optional[int] = None,
                 joint_gap: Optional[float] = None, parents: Optional[ArrayLike] = None,
                 parts: Optional[ArrayLike] = None, joints: Sequence[Joint] = (), progress: Optional[Progress] = None):
        how = options(_abi.sph_implicit_options, operation=choice("SPH_OPERATION_", operation), sample_count=samples,
                      table_size=table_size, operator_table_size=operator_table_size, joint_gap=joint_gap)
        keep: List[Any] = []
        for name, values, count in (("parents", parents, skin.bone_count), ("parts", parts, skin.vertex_count)):
            if values is not None:
                keep.append(tight(indices(np.reshape(values, (-1, 1)), 1)[:, 0], np.uint32, count))
                setattr(how, name, address(keep[-1]))
        given = (_abi.sph_implicit_joint * len(joints))()
        for joint, made in zip(joints, given):
            joint._fill(made)
        if joints:
            how.joints, how.joint_count = ctypes.cast(given, type(how.joints)), len(joints)
        self.context = skin.context
        pointer = self.context.make(lib.sph_implicit_create, skin._pointer, ctypes.byref(how), progress=progress)
        self._handle = Handle(pointer, lib.sph_implicit_destroy, self.context._handle)

    @classmethod
    def load(cls, path: PathLike, *, context: Optional[Context] = None) -> Implicit:
        """Reads a .sphm file that save() wrote."""
        context = context or default_context()
        pointer = context.make(lib.sph_io_load_implicit, context._handle.pointer, encoded(path))
        return cls._own(context, pointer, lib.sph_implicit_destroy)

    def save(self, path: PathLike) -> None:
        """Writes a .sphm file."""
        self.context.run(lib.sph_io_save_implicit, self.context._handle.pointer, self._pointer, encoded(path))

    @classmethod
    def from_bytes(cls, data: bytes, *, context: Optional[Context] = None) -> Implicit:
        """What to_bytes() wrote."""
        context = context or default_context()
        held = np.frombuffer(data, np.uint8)
        pointer = context.make(lib.sph_implicit_read, context._handle.pointer, address(held), len(held))
        return cls._own(context, pointer, lib.sph_implicit_destroy)

    def to_bytes(self) -> bytes:
        """The set-up as a .sphm container."""
        return written(self.context, lib.sph_implicit_write, self._pointer)

    @property
    def bone_count(self) -> int:
        """J"""
        return int(lib.sph_implicit_bone_count(self._pointer))

    def part(self, bone: int) -> Part:
        """A bone's part; arrays are read-only and not copied."""
        out = sized(_abi.sph_implicit_part)
        self.context.check(lib.sph_implicit_get_part(self._pointer, bone, ctypes.byref(out)))
        samples, normals = (lent(self._held, a, (out.sample_count, 3), np.float64) for a in (out.samples, out.normals))
        return Part(out.vertex_count, out.closing_count, out.radius, three(out.low), three(out.high), samples, normals)

    @property
    def joints(self) -> List[Joint]:
        """The joints, in order of their bones."""
        made = []
        for index in range(lib.sph_implicit_joint_count(self._pointer)):
            out = sized(_abi.sph_implicit_joint)
            self.context.check(lib.sph_implicit_get_joint(self._pointer, index, ctypes.byref(out)))
            made.append(Joint((out.bones[0], out.bones[1]), three(out.position), OPERATIONS[out.operation], out.strength,
                              Curve._of(out.curve)))
        return made

    def set_joint(self, index: int, joint: Joint) -> None:
        """Changes operation, strength and curve of a joint. Trackers that were made before keep what they know."""
        made = _abi.sph_implicit_joint()
        joint._fill(made)
        self.context.check(lib.sph_implicit_set_joint(self._pointer, index, ctypes.byref(made)))

    def distances(self, bone: int, points: ArrayLike) -> Tuple[Doubles, Doubles]:
        """The signed distance, about, from one bone's part in the rest pose, shape (n,), and its gradients, (n, 3)."""
        array = tight(points, np.float64, -1, 3)
        values, gradients = np.empty(len(array)), np.empty((len(array), 3))
        self.context.check(lib.sph_implicit_distances(self._pointer, bone, len(array), address(array), address(values),
                                                      address(gradients)))
        return values, gradients

    def evaluate(self, points: ArrayLike, transforms: Optional[ArrayLike] = None, *, evaluation: str = "table",
                 gradients: bool = False) -> Field:
        """The composed field at points, shape (n, 3), in a pose, shape (J, 3, 4); the rest pose if not given.

        Args:
            evaluation: "table": from grids; "exact": from the closed forms.
        """
        array = tight(points, np.float64, -1, 3)
        pose = None if transforms is None else tight(rows(transforms, 3), np.float64, self.bone_count, 3, 4)
        values, bones = np.empty(len(array)), np.empty(len(array), np.uint32)
        slopes = np.empty((len(array), 3)) if gradients else None
        self.context.run(lib.sph_implicit_evaluate, self._pointer, address(pose), choice("SPH_EVALUATION_", evaluation),
                         len(array), address(array), address(values), address(slopes), address(bones))
        return Field(values, slopes, bones)

    def tracker(self, skin: Skin, **how: Any) -> Tracker:
        """What corrects poses of a skin: see Tracker."""
        return Tracker(self, skin, **how)


class Tracker(Owned):
    """Poses a skin and corrects the result. One call at a time.

    Args:
        implicit, skin: of as many bones; may be closed afterwards.
        method: where vertices start: "linear" or "dual_quaternion".
        evaluation: "table" or "exact".
        guarded: what would make new intersections is taken back.
        smoothed: contact regions are smoothed.
        counted: reports tell how many pairs of triangles intersect before and after, which takes its time.
        iterations, smoothing_rounds, step, contact_angle, tolerance, reach: see sph_tracker_options of the headers.
    """

    def __init__(self, implicit: Implicit, skin: Skin, *, method: str = "dual_quaternion", evaluation: str = "table",
                 guarded: bool = True, smoothed: bool = True, counted: bool = False, iterations: Optional[int] = None,
                 smoothing_rounds: Optional[int] = None, step: Optional[float] = None,
                 contact_angle: Optional[float] = None, tolerance: Optional[float] = None,
                 reach: Optional[float] = None):
        flags = ((0 if guarded else _abi.SPH_TRACKER_UNGUARDED) | (0 if smoothed else _abi.SPH_TRACKER_UNSMOOTHED) |
                 (_abi.SPH_TRACKER_COUNTED if counted else 0))
        how = options(_abi.sph_tracker_options, flags=flags, method=choice("SPH_POSE_", method),
                      evaluation=choice("SPH_EVALUATION_", evaluation), iteration_limit=iterations,
                      smoothing_rounds=smoothing_rounds, step=step, contact_angle=contact_angle, tolerance=tolerance,
                      reach=reach)
        self.context = skin.context
        self.vertex_count, self.bone_count = skin.vertex_count, skin.bone_count
        pointer = self.context.make(lib.sph_tracker_create, implicit._pointer, skin._pointer, ctypes.byref(how))
        self._handle = Handle(pointer, lib.sph_tracker_destroy, self.context._handle)

    def pose(self, transforms: ArrayLike, *, normals: bool = False, out: Optional[Floats] = None,
             progress: Optional[Progress] = None) -> TrackedPose:
        """Corrected positions, and normals where asked for, under transforms of the bones.

        Args:
            transforms: shape (J, 3, 4) for one pose, (poses, J, 3, 4) for many; also with 4 rows.
            out: float32 array for the positions.
        """
        array = np.asarray(transforms, np.float64)
        many = array.ndim == 4
        array = tight(rows(array if many else array[np.newaxis], 4), np.float64, -1, self.bone_count, 3, 4)
        shape: Tuple[int, ...] = (self.vertex_count, 3)
        shape = (len(array), *shape) if many else shape
        positions, reports = filled(out, np.float32, *shape), np.zeros(len(array), TRACKER_REPORT)
        turned = np.empty(shape, np.float32) if normals else None
        self.context.run(lib.sph_tracker_pose, self._pointer, address(array), len(array), address(positions),
                         address(turned), struct_at(_abi.sph_tracker_report, reports), progress=progress)
        return TrackedPose(positions, turned, reports)


def compose(operation: str, theta: float, first: float, second: float, *,
            strength: float = 0) -> Tuple[float, Tuple[float, float]]:
    """Two field values composed by the closed form of an operator, and the derivatives by either."""
    values, slopes, out = (ctypes.c_double * 2)(first, second), (ctypes.c_double * 2)(), ctypes.c_double()
    context = default_context()
    context.check(lib.sph_operation_compose(choice("SPH_OPERATION_", operation), strength, theta, values,
                                            ctypes.byref(out), slopes))
    return out.value, (slopes[0], slopes[1])


def intersections(positions: ArrayLike, triangles: ArrayLike, *, context: Optional[Context] = None) -> int:
    """How many pairs of triangles of a mesh intersect, exactly."""
    context = context or default_context()
    points, faces, out = tight(positions, np.float32, -1, 3), indices(triangles, 3), ctypes.c_uint64()
    context.run(lib.sph_mesh_intersections, context._handle.pointer, len(points), address(points), len(faces),
                address(faces), ctypes.byref(out))
    return out.value
