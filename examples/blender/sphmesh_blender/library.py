# SPDX-License-Identifier: MIT
"""Where the Python package comes from: the add-on's own folder, the preferences, or Python's path."""
import importlib
import os
import pathlib
import sys

BESIDE = pathlib.Path(__file__).parent / "sphmesh"


def load(package_folder="", library_folder=""):
    """The package sphmesh. Folders are those of the preferences; empty: not given.

    Raises ImportError, with a text for the user.
    """
    if library_folder:
        os.environ["SPHMESH_LIBRARY_PATH"] = library_folder
    if package_folder:
        if package_folder not in sys.path:
            sys.path.insert(0, package_folder)
        package = importlib.import_module("sphmesh")
    elif BESIDE.is_dir():
        package = importlib.import_module(".sphmesh", __package__)
    else:
        try:
            package = importlib.import_module("sphmesh")
        except ModuleNotFoundError:
            raise ImportError("The Python package sphmesh was not found. Name its folder in the add-on's preferences, "
                              "or install the add-on from the zip that `ninja blender-addon` makes.") from None
    package.library_version()  # finds the shared libraries now, or tells what is missing
    return package
