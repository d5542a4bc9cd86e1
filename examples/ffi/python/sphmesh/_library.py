# SPDX-License-Identifier: MIT
"""Finds the shared libraries, and types their functions as the headers have them."""
from __future__ import annotations

import ctypes
import os
import pathlib
import shutil
import subprocess
import sys
from typing import Any, Dict, List

from . import _abi

PATH_VARIABLE = "SPHMESH_LIBRARY_PATH"
BUNDLED = pathlib.Path(__file__).parent / "lib"
BINARY_INTERFACE = 0  # the number in the soname


def file_name(name: str) -> str:
    """What the loader calls a library, e.g. libsphmesh.so.0."""
    if sys.platform == "darwin":
        return f"lib{name}.{BINARY_INTERFACE}.dylib"
    return f"lib{name}.so.{BINARY_INTERFACE}"


def _folders_of_pkg_config() -> List[str]:
    if shutil.which("pkg-config") is None:
        return []
    asked = subprocess.run(["pkg-config", "--variable=libdir", "sphmesh"], capture_output=True, text=True)
    return [asked.stdout.strip()] if asked.returncode == 0 else []


def candidates(name: str) -> List[str]:
    """Where a library may be, best first: full paths, and the bare name for the loader's own search.

    The folders of SPHMESH_LIBRARY_PATH, and of a build tree their `io`, exclude all others when the variable is set.
    """
    file = file_name(name)
    given = [folder for folder in os.environ.get(PATH_VARIABLE, "").split(os.pathsep) if folder]
    if given:
        return [os.path.join(folder, below, file) for folder in given for below in ("", "io")]
    bundled = BUNDLED / file
    return ([str(bundled)] if bundled.exists() else []) + [file]


def load(name: str) -> ctypes.CDLL:
    tried: List[str] = []

    def attempt(places: List[str]) -> Any:
        for place in places:
            if os.path.isabs(place) and not os.path.exists(place):
                tried.append(f"{place}: no such file")
                continue
            try:
                return ctypes.CDLL(place)
            except OSError as error:
                tried.append(str(error))
        return None

    found = attempt([place if place == file_name(name) else os.path.abspath(place) for place in candidates(name)])
    if found is None and not os.environ.get(PATH_VARIABLE):
        found = attempt([os.path.join(folder, file_name(name)) for folder in _folders_of_pkg_config()])
    if found is None:
        raise ImportError(f"{file_name(name)} was not found. Install libsphmesh, or name the folder it is in by "
                          f"{PATH_VARIABLE}. Tried: " + "; ".join(tried))
    return found  # type: ignore[no-any-return]


class Library:
    """Both libraries: `lib.sph_x(...)` is the C function, with the types of its header."""

    def __init__(self) -> None:
        self._loaded: Dict[str, ctypes.CDLL] = {}

    def _load(self, name: str) -> ctypes.CDLL:
        if name not in self._loaded:
            if name != "sphmesh":
                self._load("sphmesh")  # by its soname it is then the one that the other asks for
            loaded = self._loaded[name] = load(name)
            if name == "sphmesh":
                loaded.sph_version.restype = ctypes.c_uint32
                major = loaded.sph_version() // 1000000
                if major != _abi.SPH_VERSION_MAJOR:
                    raise ImportError(f"libsphmesh has version {loaded.sph_version()}, which this package does not know")
        return self._loaded[name]

    def __getattr__(self, name: str) -> Any:
        if name not in _abi.PROTOTYPES:
            raise AttributeError(name)
        library = self._load("sphmesh-io" if name.startswith("sph_io_") else "sphmesh")
        try:
            function = getattr(library, name)
        except AttributeError:
            raise NotImplementedError(f"this libsphmesh is too old: it has no {name}()") from None
        function.restype, function.argtypes = _abi.PROTOTYPES[name]
        setattr(self, name, function)
        return function


lib = Library()
