# SPDX-License-Identifier: MIT
"""Handles, calls and what the library calls back: exceptions go through C unharmed, and so does Ctrl-C."""
from __future__ import annotations

import ctypes
import logging
import sys
import threading
import weakref
from typing import Any, Callable, List, Optional, Tuple, Type, TypeVar

from . import _abi
from ._library import lib
from .errors import BY_STATUS, SphmeshError, StateError

Progress = Callable[[str, float], Optional[bool]]
LOG = logging.getLogger("sphmesh")
LEVELS = {_abi.SPH_LOG_WARNING: logging.WARNING, _abi.SPH_LOG_INFO: logging.INFO, _abi.SPH_LOG_DEBUG: logging.DEBUG}


class Handle:
    """One handle of the library. It is destroyed when nobody holds it any more, and before what it was made from."""

    __slots__ = ("pointer", "__weakref__")

    def __init__(self, pointer: int, destroy: Callable[[int], None], *keep: Any):
        self.pointer = pointer
        weakref.finalize(self, _destroy, destroy, pointer, keep)


def _destroy(destroy: Callable[[int], None], pointer: int, keep: Tuple[Any, ...]) -> None:
    destroy(pointer)  # and only then `keep` goes


class _Call(threading.local):
    """What a thread is in the midst of."""

    progress: Optional[Progress] = None
    error: Optional[BaseException] = None
    refused = False


_call = _Call()


def report(error: BaseException) -> None:
    """Notes an exception of a callback; the call that is under way raises it when it returns."""
    if _call.error is None:
        _call.error = error


def _on_progress(user: Optional[int], stage: bytes, fraction: float) -> bool:
    try:
        if _call.error is None and _call.progress is not None:
            _call.refused = _call.progress(stage.decode(), fraction) is False
    except BaseException as error:
        report(error)
    return _call.error is None and not _call.refused


def _on_log(user: Optional[int], severity: int, message: bytes) -> None:
    try:
        LOG.log(LEVELS.get(severity, logging.INFO), "%s", message.decode(errors="replace"))
    except BaseException as error:
        report(error)


_progress, _log = _abi.sph_progress_fn(_on_progress), _abi.sph_log_fn(_on_log)


class _Unraisable:
    """Catches what is raised between C and the first line of a callback, where no `try` is yet: Ctrl-C mostly."""

    def __enter__(self) -> None:
        self.before = sys.unraisablehook
        sys.unraisablehook = self.take

    def __exit__(self, *_: Any) -> None:
        sys.unraisablehook = self.before

    def take(self, told: Any) -> None:
        if isinstance(told.exc_value, KeyboardInterrupt):
            report(told.exc_value)
        else:
            self.before(told)


class Context:
    """The library's link to its host: threads, memory, progress.

    Args:
        threads: threads that the library uses, the caller's included; 0: one per processor.
        memory_limit: bytes that everything made with this context may hold together; 0: no limit.
        progress: called as progress(stage, fraction) in all long calls that are not given one of their own. Answering
            False cancels the call, which raises CancelledError; an exception cancels it too, and comes out of it.

    Messages of the library go to the logger "sphmesh" of the module logging.
    """

    def __init__(self, *, threads: int = 0, memory_limit: int = 0, progress: Optional[Progress] = None):
        self.progress = progress
        self._make(options(_abi.sph_context_options, thread_count=threads, memory_limit=memory_limit))

    def _make(self, made: Any, *keep: Any) -> None:
        made.log, made.progress = _log, _progress
        out = ctypes.c_void_p()
        status = lib.sph_context_create(ctypes.byref(made), ctypes.byref(out))
        if status != _abi.SPH_OK or out.value is None:
            raise BY_STATUS.get(status, SphmeshError)(lib.sph_status_text(status).decode())
        self._handle = Handle(out.value, lib.sph_context_destroy, *keep)

    @property
    def memory_used(self) -> int:
        """Bytes that everything made with this context holds now."""
        return int(lib.sph_context_memory_used(self._handle.pointer))

    @property
    def memory_peak(self) -> int:
        """The most that it was."""
        return int(lib.sph_context_memory_peak(self._handle.pointer))

    def check(self, status: int) -> None:
        """Raises what a status stands for."""
        if status != _abi.SPH_OK:
            message = lib.sph_context_last_message(self._handle.pointer) or lib.sph_status_text(status)
            raise BY_STATUS.get(status, SphmeshError)(message.decode(errors="replace"))

    def run(self, function: Any, *arguments: Any, progress: Optional[Progress] = None) -> None:
        """A call that may take long, or call back."""
        before = _call.progress, _call.error, _call.refused
        _call.progress, _call.error, _call.refused = progress or self.progress or _call.progress, None, False
        try:
            if threading.current_thread() is threading.main_thread():
                with _Unraisable():
                    status = function(*arguments)
            else:
                status = function(*arguments)
            error = _call.error
        finally:
            _call.progress, _call.error, _call.refused = before
        if error is not None:
            raise error
        self.check(status)

    def make(self, function: Any, *arguments: Any, progress: Optional[Progress] = None) -> int:
        """A call whose last argument is where it puts a new handle."""
        out = ctypes.c_void_p()
        self.run(function, *arguments, ctypes.byref(out), progress=progress)
        assert out.value is not None
        return out.value


_default: List[Context] = []
_lock = threading.Lock()


def default_context() -> Context:
    """The context of everything that is not given one: one thread per processor, no limits."""
    with _lock:
        if not _default:
            _default.append(Context())
    return _default[0]


Self = TypeVar("Self", bound="Owned")


class Owned:
    """An object that holds a handle of the library: until close(), the end of a `with` block, or the last reference.

    Arrays that were lent keep what they need alive, so that closing never leaves one dangling.
    """

    _handle: Optional[Handle] = None
    context: Context

    @property
    def _pointer(self) -> int:
        if self._handle is None:
            raise StateError(f"this {type(self).__name__} is closed")
        return self._handle.pointer

    @property
    def _held(self) -> Handle:
        self._pointer
        assert self._handle is not None
        return self._handle

    def close(self) -> None:
        """Gives the memory back now, or when the last array that shows it is gone."""
        self._handle = None

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    @classmethod
    def _own(cls: Type[Self], context: Context, pointer: int, destroy: Any, *keep: Any) -> Self:
        made = cls.__new__(cls)
        made.context = context
        made._handle = Handle(pointer, destroy, context._handle, *keep)
        return made


class Record:
    """The fields of a struct that the library has filled, as attributes."""

    def __init__(self, struct: Any):
        for field in struct._fields_:
            name = field[0]
            if name != "struct_size" and not name.startswith("reserved"):
                value = getattr(struct, name)
                self.__dict__[name] = tuple(value) if isinstance(value, ctypes.Array) else (
                    Record(value) if isinstance(value, ctypes.Structure) else
                    value.decode() if isinstance(value, bytes) else value)

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(name)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("what the library has told cannot be changed")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Record) and self.__dict__ == other.__dict__

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return "Record(" + ", ".join(f"{name}={value!r}" for name, value in self.__dict__.items()) + ")"


def options(struct: Any, **fields: Any) -> Any:
    """An options struct with the library's defaults; fields that are None stay as they are."""
    made = struct()
    getattr(lib, struct.__name__ + "_init")(ctypes.byref(made), ctypes.sizeof(made))
    for name, value in fields.items():
        if value is not None:
            setattr(made, name, value)
    return made


def sized(struct: Any) -> Any:
    """A struct that the library fills."""
    made = struct()
    made.struct_size = ctypes.sizeof(made)
    return made


def choice(prefix: str, word: str) -> int:
    """The constant that a word stands for: choice("SPH_RADIUS_", "per_frame")."""
    value = getattr(_abi, prefix + word.upper(), None)
    if value is None:
        words = sorted(name[len(prefix):].lower() for name in vars(_abi) if name.startswith(prefix))
        raise ValueError(f"{word!r} is none of {', '.join(words)}")
    return int(value)
