# SPDX-License-Identifier: MIT
"""The declarations are the headers', and everything that is public is explained and typed."""
import inspect
import os
import pathlib
import re
import shutil
import subprocess
import sys

import pytest
import sphmesh
from sphmesh import _abi, _library

PACKAGE = pathlib.Path(sphmesh.__file__).parent
FFI = PACKAGE.parent.parent
INCLUDE = FFI.parent.parent / "include"
WRITER = FFI / "declarations.py"


def written(kind):
    pytest.importorskip("pycparser")
    return subprocess.run([sys.executable, WRITER, kind, INCLUDE], check=True, capture_output=True, text=True).stdout


@pytest.mark.parametrize("kind, file", [("python", PACKAGE / "_abi.py"), ("lua", FFI / "lua/sphmesh/declarations.lua")])
def test_declarations_are_those_of_the_headers(kind, file):
    assert file.read_text() == written(kind), "the headers have changed: run `ninja ffi-declarations`"


@pytest.fixture(scope="module")
def layout(tmp_path_factory):
    """What the C compiler makes of the headers: "struct" and size, "struct.field" and offset and size, constants."""
    source = tmp_path_factory.mktemp("layout") / "layout.c"
    source.write_text(written("layout"))
    compiler = os.environ.get("CC", "cc").split()
    subprocess.run([*compiler, "-I", INCLUDE, "-o", source.with_suffix(""), source], check=True)
    told = subprocess.check_output([source.with_suffix("")], text=True)
    return dict(line.split(" ", 1) for line in told.splitlines())


def test_structs_and_constants_are_what_the_c_compiler_makes_of_them(layout):
    told = layout
    structs = {struct.__name__: struct for struct in _abi.STRUCTS}
    for name, expected in told.items():
        struct, _, field = name.partition(".")
        if field:
            found = getattr(structs[struct], field)
            assert (name, f"{found.offset} {found.size}") == (name, expected)
        elif name in structs:
            assert (name, _abi.c.sizeof(structs[name])) == (name, int(expected))
        else:
            assert (name, float(getattr(_abi, name))) == (name, float(expected))
    fields = sum(len(struct._fields_) for struct in _abi.STRUCTS)
    constants = sum(name.startswith("SPH_") for name in vars(_abi))
    assert len(told) == len(structs) + fields + constants


@pytest.mark.skipif(shutil.which("luajit") is None, reason="LuaJIT is not installed")
def test_luajit_sees_what_the_c_compiler_makes_of_them(layout):
    structs = {struct.__name__ for struct in _abi.STRUCTS}
    lines = [f'print("{name}", ffi.sizeof "{name}")' if name in structs else
             f'print("{name}", ffi.offsetof("{name.partition(".")[0]}", "{name.partition(".")[2]}"))'
             for name in layout if name in structs or "." in name]
    lines += [f'print("{name}", c["{name}"] or tonumber(ffi.C["{name}"]))' for name in layout if name.startswith("SPH_")]
    code = 'local ffi = require "ffi" local d = require "declarations" local c = d.constants ffi.cdef(d.cdef)\n'
    told = subprocess.check_output(["luajit", "-"], cwd=FFI / "lua/sphmesh", text=True, input=code + "\n".join(lines))
    found = dict(line.split("\t") for line in told.splitlines())
    assert found.keys() == layout.keys()
    for name, expected in layout.items():
        assert (name, float(found[name])) == (name, float(expected.split()[0]))


def test_every_function_of_the_headers_is_declared_and_in_the_libraries():
    text = "".join(re.sub(r"/\*.*?\*/", "", h.read_text(), flags=re.S) for h in (INCLUDE / "sphmesh").glob("*.h"))
    declared = set(re.findall(r"SPH_API[^;(]*?\b(sph_\w+)\s*\(", text))
    assert declared == set(_abi.PROTOTYPES)
    for name in declared:
        assert callable(getattr(sphmesh.lib, name))


# What there is another way for: importers are functions, whole arrays take the place of single elements.
NOT_WRAPPED = set("""sph_context_fail sph_context_allocate sph_context_release sph_context_report_progress sph_context_log
    sph_context_parallel_for sph_animation_create sph_animation_set_frame sph_hierarchy_collapse sph_level_create
    sph_query_pose_frame sph_io_sort_natural""".split())


def test_every_other_function_of_the_libraries_is_used():
    text = "".join(f.read_text() for f in PACKAGE.glob("*.py") if f.name != "_abi.py")
    used = set(re.findall(r"lib\.(sph_\w+)", text))
    used |= {name + "_init" for name in re.findall(r"options\(_abi\.(sph_\w+)", text)}
    assert set(_abi.PROTOTYPES) - used == NOT_WRAPPED


def test_everything_public_has_a_docstring():
    for name in sphmesh.__all__:
        thing = getattr(sphmesh, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert thing.__doc__, name
        for member, value in vars(thing).items() if inspect.isclass(thing) else ():
            if not member.startswith("_") and (inspect.isfunction(value) or isinstance(value, property)):
                assert value.__doc__, f"{name}.{member}"


@pytest.mark.skipif(shutil.which("mypy") is None, reason="mypy is not installed")
def test_types_satisfy_mypy():
    done = subprocess.run(["mypy", "--strict", "--cache-dir=/dev/null", PACKAGE], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_the_first_lines_of_the_readme_work(tmp_path):
    code = re.search(r"```python\n(.*?)```", (PACKAGE.parent / "README.md").read_text(), flags=re.S)[1]
    assert len(code.splitlines()) <= 10
    told = subprocess.check_output([sys.executable, "-c", code], cwd=tmp_path, text=True,
                                   env={**os.environ, "PYTHONPATH": str(PACKAGE.parent)})
    assert re.fullmatch(r"\(10, 24, 3\) \[3\.[67]\d*\]\n", told)
    assert (tmp_path / "level.json").exists()


def test_a_library_that_is_not_there_is_told_with_every_place(monkeypatch):
    monkeypatch.setenv(_library.PATH_VARIABLE, "/nowhere")
    with pytest.raises(ImportError, match="/nowhere/libsphmesh.so.0"):
        _library.load("sphmesh")


@pytest.mark.skipif(shutil.which("pkg-config") is None, reason="pkg-config is not installed")
def test_installed_libraries_are_found_through_pkg_config(tmp_path):
    libraries = os.environ.get(_library.PATH_VARIABLE)
    if not libraries:
        pytest.skip("the libraries are installed where the loader finds them")
    for name in ("sphmesh", "sphmesh-io"):
        file = _library.file_name(name)
        place = next(p for p in _library.candidates(name) if os.path.exists(p))
        (tmp_path / file).symlink_to(os.path.abspath(place))
    (tmp_path / "sphmesh.pc").write_text(f"libdir={tmp_path}\nName: sphmesh\nDescription: x\nVersion: 0\n")
    environment = {**os.environ, "PKG_CONFIG_PATH": str(tmp_path), "PYTHONPATH": str(PACKAGE.parent)}
    del environment[_library.PATH_VARIABLE]
    code = "import sphmesh; sphmesh.Level([[0, 0, 0]], [1]).save('one.json'); print(sphmesh.library_version())"
    told = subprocess.check_output([sys.executable, "-c", code], cwd=tmp_path, env=environment, text=True)
    assert int(told) == _abi.SPH_VERSION


def test_a_function_that_the_library_lacks_is_named(monkeypatch):
    monkeypatch.setitem(_abi.PROTOTYPES, "sph_of_tomorrow", (None, []))
    with pytest.raises(NotImplementedError, match="sph_of_tomorrow"):
        _library.Library().sph_of_tomorrow


def test_the_version_is_that_of_the_headers():
    assert sphmesh.library_version() == _abi.SPH_VERSION
