# SPDX-License-Identifier: MIT
"""The rigged mesh of a glTF as it is in the file."""
from __future__ import annotations

import ctypes
from typing import Any, List, Optional

import numpy as np
from numpy.typing import NDArray

from . import _abi
from ._arrays import Doubles, Indices, lent
from ._calls import Context, Handle, Owned, Progress, default_context, sized
from ._library import lib
from .animation import PathLike, encoded
from .skin import Skin, nothing, open_rig_options


class Rig(Owned):
    """The skin of a glTF, and what its joints are besides. Bones are in the order of the skin's.

    Args:
        path: the file, which is not needed any more when this returns.
        clip: the animation to take, by name or number; all if not given.
        fps: frames per second that clips are taken at; 0: 30.
        first_frame, end_frame, frame_step: which frames; end_frame 0: to the end.
    """

    def __init__(self, path: PathLike, *, clip: Optional[str] = None, fps: float = 0, first_frame: int = 0,
                 end_frame: int = 0, frame_step: int = 1, progress: Optional[Progress] = None,
                 context: Optional[Context] = None):
        self.context = context or default_context()
        how = open_rig_options(clip, fps, first_frame, end_frame, frame_step)
        pointer = self.context.make(lib.sph_io_open_rig, self.context._handle.pointer, encoded(path),
                                    ctypes.byref(how), progress=progress)
        self._handle = Handle(pointer, lib.sph_io_rig_destroy, self.context._handle)

    @property
    def skin(self) -> Skin:
        """Rest pose, weights, and transforms from there to the scene in every frame."""
        return Skin._own(self.context, lib.sph_io_rig_skin(self._pointer), nothing, self._held)

    @property
    def _arrays(self) -> Any:
        out = sized(_abi.sph_io_rig_arrays)
        self.context.check(lib.sph_io_rig_get_arrays(self._pointer, ctypes.byref(out)))
        return out

    def _array(self, name: str, kind: Any, *shape: Any) -> NDArray[Any]:
        a = self._arrays
        return lent(self._held, getattr(a, name), tuple(getattr(a, s) if isinstance(s, str) else s for s in shape), kind)

    @property
    def names(self) -> List[str]:
        """Of the joints' nodes."""
        a = self._arrays
        return [a.names[i].decode(errors="replace") for i in range(a.bone_count)]

    @property
    def nodes(self) -> Indices:
        """Shape (J,): numbers of the joints' nodes in the file."""
        return self._array("nodes", np.uint32, "bone_count")

    @property
    def parents(self) -> Indices:
        """Shape (J,): the bone that each hangs on, or NO_JOINT; as Implicit takes it."""
        return self._array("parents", np.uint32, "bone_count")

    @property
    def inverse_bind(self) -> Doubles:
        """Shape (J, 3, 4): mesh to joint in the rest pose."""
        return self._array("inverse_bind", np.float64, "bone_count", 3, 4)

    @property
    def joints_rest(self) -> Doubles:
        """Shape (J, 3, 4): joint to scene, nodes at rest."""
        return self._array("joints_rest", np.float64, "bone_count", 3, 4)

    @property
    def joints(self) -> Doubles:
        """Shape (F, J, 3, 4): joint to scene in a frame."""
        return self._array("joints", np.float64, "frame_count", "bone_count", 3, 4)

    @property
    def edges(self) -> Indices:
        """Shape (e, 2): lines of the file's."""
        return self._array("edges", np.uint32, "edge_count", 2)

    @property
    def morphs(self) -> bool:
        """Whether a clip moves morph targets, which the skin does not know of."""
        return bool(self._arrays.morphs)
