# SPDX-License-Identifier: MIT
"""New poses of a skin, and its bones as a tree of joints."""
from __future__ import annotations

import ctypes
from typing import Any, NamedTuple, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _abi
from ._arrays import Doubles, Floats, Indices, address, filled, lent, tight
from ._calls import Handle, Owned, Progress, choice, options, sized
from ._library import lib
from .skin import Skin, rows


class Pose(NamedTuple):
    """What a deformer gives: shape (n, 3) each, or (poses, n, 3)."""

    positions: Floats
    normals: Optional[Floats]


class Deformer(Owned):
    """Moves the vertices of a skin to new poses. One call at a time.

    Args:
        skin: may be closed afterwards.
        normals: shape (n, 3): of the rest pose; those of the triangles if not given.
    """

    def __init__(self, skin: Skin, normals: Optional[ArrayLike] = None):
        self.context = skin.context
        self.vertex_count, self.bone_count = skin.vertex_count, skin.bone_count
        given = None if normals is None else tight(normals, np.float32, self.vertex_count, 3)
        how = options(_abi.sph_deformer_options, normals=address(given))
        pointer = self.context.make(lib.sph_deformer_create, skin._pointer, ctypes.byref(how))
        self._handle = Handle(pointer, lib.sph_deformer_destroy, self.context._handle)

    def pose(self, transforms: ArrayLike, *, method: str = "linear", normals: bool = False,
             out: Optional[Floats] = None, progress: Optional[Progress] = None) -> Pose:
        """Positions, and normals where asked for, under transforms of the bones.

        Args:
            transforms: shape (J, 3, 4) for one pose, (poses, J, 3, 4) for many; also with 4 rows.
            method: "linear" or "dual_quaternion".
            out: float32 array for the positions.
        """
        array = np.asarray(transforms, np.float64)
        many = array.ndim == 4
        array = tight(rows(array if many else array[np.newaxis], 4), np.float64, -1, self.bone_count, 3, 4)
        shape: Tuple[int, ...] = (self.vertex_count, 3)
        shape = (len(array), *shape) if many else shape
        positions = filled(out, np.float32, *shape)
        turned = np.empty(shape, np.float32) if normals else None
        self.context.run(lib.sph_deformer_pose, self._pointer, address(array), len(array), choice("SPH_POSE_", method),
                         address(positions), address(turned), progress=progress)
        return Pose(positions, turned)


class Skeleton(Owned):
    """The bones of a skin as a tree of joints. Joint j is that of bone j; a single root, if asked for, comes last.

    Args:
        skin: may be closed afterwards.
        layout: "tree" or "flat".
        root: "center", "heaviest", or the number of a bone.
        single_root: one joint more, that does not move, and that all others hang on.
    """

    def __init__(self, skin: Skin, *, layout: str = "tree", root: Any = "center", single_root: bool = False,
                 progress: Optional[Progress] = None):
        self.context = skin.context
        given = not isinstance(root, str)
        how = options(_abi.sph_skeleton_options, layout=choice("SPH_SKELETON_", layout),
                      root=_abi.SPH_ROOT_GIVEN if given else choice("SPH_ROOT_", root),
                      root_bone=root if given else None, single_root=int(single_root))
        pointer = self.context.make(lib.sph_skeleton_create, skin._pointer, ctypes.byref(how), progress=progress)
        self._handle = Handle(pointer, lib.sph_skeleton_destroy, self.context._handle)

    def _array(self, name: str, kind: Any, *shape: int) -> NDArray[Any]:
        a = sized(_abi.sph_skeleton_arrays)
        self.context.check(lib.sph_skeleton_get_arrays(self._pointer, ctypes.byref(a)))
        return lent(self._held, getattr(a, name), (a.joint_count, *shape), kind)

    @property
    def parents(self) -> Indices:
        """Shape (joints,): of each joint the one that it hangs on, or NO_JOINT."""
        return self._array("parents", np.uint32)

    @property
    def order(self) -> Indices:
        """Shape (joints,): all joints, each after its parent."""
        return self._array("order", np.uint32)

    @property
    def positions(self) -> Doubles:
        """Shape (joints, 3): in the rest pose."""
        return self._array("positions", np.float64, 3)

    @property
    def rest(self) -> Doubles:
        """Shape (joints, 3, 4): joint to parent in the rest pose."""
        return self._array("rest", np.float64, 3, 4)

    @property
    def inverse_bind(self) -> Doubles:
        """Shape (joints, 3, 4): model to joint in the rest pose."""
        return self._array("inverse_bind", np.float64, 3, 4)

    @property
    def gaps(self) -> Doubles:
        """Shape (joints,): how far a bone and its parent's take the joint apart."""
        return self._array("gaps", np.float64)

    def locals_of(self, transforms: ArrayLike) -> Doubles:
        """A pose of the bones, shape (J, 3, 4), as that of the joints relative to their parents, (joints, 3, 4)."""
        a = sized(_abi.sph_skeleton_arrays)
        self.context.check(lib.sph_skeleton_get_arrays(self._pointer, ctypes.byref(a)))
        array = tight(rows(transforms, 3), np.float64, a.bone_count, 3, 4)
        out = np.empty((a.joint_count, 3, 4))
        self.context.check(lib.sph_skeleton_get_locals(self._pointer, address(array), address(out)))
        return out

    def transforms_of(self, locals: ArrayLike) -> Doubles:
        """The other way round."""
        a = sized(_abi.sph_skeleton_arrays)
        self.context.check(lib.sph_skeleton_get_arrays(self._pointer, ctypes.byref(a)))
        array = tight(rows(locals, 3), np.float64, a.joint_count, 3, 4)
        out = np.empty((a.bone_count, 3, 4))
        self.context.check(lib.sph_skeleton_get_transforms(self._pointer, address(array), address(out)))
        return out
