# SPDX-License-Identifier: MIT
"""NumPy arrays to C and back, without copies wherever the layout allows."""
from __future__ import annotations

import ctypes
from typing import Any, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _abi
from ._calls import Handle

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]
Indices = NDArray[np.uint32]

SWEEP = np.dtype(_abi.sph_sweep)  #: what cast() takes
HIT = np.dtype(_abi.sph_hit)  #: what cast() answers
NEAREST = np.dtype(_abi.sph_nearest)  #: what nearest() answers
CONTACT = np.dtype(_abi.sph_contact)  #: a place on a level
COLLAPSE = np.dtype(_abi.sph_collapse)  #: one step of a hierarchy
DISTANCES = np.dtype(_abi.sph_distances)  #: what measure() tells of each frame
TRACKER_REPORT = np.dtype(_abi.sph_tracker_report)  #: what Tracker.pose() did to each pose
SKIN_ERROR = np.dtype(_abi.sph_skin_error)  #: what Skin.errors() tells of each frame


class _Lent:
    """Memory of the library's, which the handle keeps alive."""

    def __init__(self, handle: Handle, address: int, shape: Tuple[int, ...], kind: str):
        self.handle = handle
        self.__array_interface__ = {"version": 3, "shape": shape, "typestr": kind, "data": (address, True)}


def lent(handle: Handle, address: Optional[int], shape: Tuple[int, ...], kind: Any) -> NDArray[Any]:
    """A read-only array over memory that the handle keeps."""
    kind = np.dtype(kind)
    if not address or 0 in shape:
        empty = np.empty(shape if 0 in shape else (0,) + shape[1:], kind)
        empty.setflags(write=False)
        return empty
    return np.asarray(_Lent(handle, address, shape, kind.str))


def address(array: Optional[NDArray[Any]]) -> Optional[int]:
    return None if array is None else int(array.__array_interface__["data"][0])


def struct_at(struct: Any, array: NDArray[Any]) -> Any:
    """A reference to the first element of an array of structs."""
    return ctypes.byref(struct.from_address(address(array))) if len(array) else None


def tight(values: ArrayLike, kind: Any, *shape: int) -> NDArray[Any]:
    """`values` as one C array; -1 in `shape` is any number. Copied only where type or layout differ."""
    array = np.require(values, kind, ["C", "ALIGNED"])
    if array.size == 0 and array.ndim == 1:
        array = array.reshape([0 if n < 0 else n for n in shape])
    if array.ndim != len(shape) or any(want not in (-1, have) for want, have in zip(shape, array.shape)):
        wanted = ", ".join("any" if n < 0 else str(n) for n in shape)
        raise ValueError(f"an array of shape {array.shape} where ({wanted}) is needed")
    return array


def indices(values: ArrayLike, corners: int) -> Indices:
    """Rows of indices. Signed ones, as NumPy makes by itself, are looked at before they are taken for unsigned."""
    array = np.asarray(values)
    if array.size and array.dtype != np.uint32:
        if array.dtype.kind not in "iu":
            raise ValueError(f"indices must be whole numbers, not {array.dtype}")
        if array.min() < 0 or array.max() > 0xFFFFFFFF:
            raise ValueError(f"index {array.min() if array.min() < 0 else array.max()} is out of range")
    return tight(array, np.uint32, -1, corners)


def strided(points: ArrayLike, kind: Any = np.float32) -> Tuple[NDArray[Any], int]:
    """Points of shape (n, 3), and the bytes from one to the next. Rows of a larger array are taken as they are."""
    array = np.asarray(points, dtype=kind)
    if array.ndim == 1 and array.size == 3:
        array = array.reshape(1, 3)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"points of shape {array.shape} where (any, 3) is needed")
    size = array.itemsize
    if not array.flags.aligned or array.strides[1] != size or array.strides[0] < 3 * size:
        array = np.require(array, kind, ["C", "ALIGNED"])
    return array, array.strides[0] if len(array) > 1 else 3 * size


def filled(out: Optional[NDArray[Any]], kind: Any, *shape: int) -> NDArray[Any]:
    """The caller's array, if it is one that C can fill, or a new one."""
    if out is None:
        return np.empty(shape, kind)
    if out.dtype != np.dtype(kind) or out.shape != shape or not out.flags.c_contiguous or not out.flags.writeable:
        raise ValueError(f"out must be a writable C array of {np.dtype(kind)} and shape {shape}")
    return out
