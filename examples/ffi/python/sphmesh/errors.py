# SPDX-License-Identifier: MIT
"""What a call of the library can fail with: a class for each status, with the library's own message."""
from __future__ import annotations

from typing import Dict, Type

from . import _abi


class SphmeshError(Exception):
    """A call of the library failed. The text names what was wrong: the frame, vertex, file or byte."""

    status: int = -1


class InvalidError(SphmeshError, ValueError):
    """An argument or the input is wrong."""

    status = _abi.SPH_E_INVALID


class OutOfMemoryError(SphmeshError, MemoryError):
    """There is no memory, or a memory limit is reached."""

    status = _abi.SPH_E_NOMEM


class CancelledError(SphmeshError):
    """Progress was answered with False."""

    status = _abi.SPH_E_CANCELLED


class VersionError(SphmeshError):
    """Made by a newer version than the library that runs."""

    status = _abi.SPH_E_VERSION


class InputOutputError(SphmeshError, OSError):
    """The operating system, or a frame source, failed to read or write."""

    status = _abi.SPH_E_IO


class FormatError(SphmeshError, ValueError):
    """The content of a file is damaged, or not of the format that it claims."""

    status = _abi.SPH_E_FORMAT


class UnsupportedError(SphmeshError):
    """Valid, but not something that the library does."""

    status = _abi.SPH_E_UNSUPPORTED


class LimitError(SphmeshError):
    """Beyond a limit of the caller's or the library's."""

    status = _abi.SPH_E_LIMIT


class StateError(SphmeshError, RuntimeError):
    """Not possible with this object as it is."""

    status = _abi.SPH_E_STATE


BY_STATUS: Dict[int, Type[SphmeshError]] = {
    kind.status: kind
    for kind in (InvalidError, OutOfMemoryError, CancelledError, VersionError, InputOutputError, FormatError,
                 UnsupportedError, LimitError, StateError)
}
