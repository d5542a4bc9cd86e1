#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compiles or runs every fenced block of the pages, so that none of them is wrong. Speaks TAP.

usage: check_docs.py SOURCE BUILD [PAGE...]

    ```c        a program is compiled, linked and run, and kept where its first line is /* NAME.c */; a fragment is compiled as
                part of a function, or as a file where it has includes, types or functions of its own
    ```sh       runs in an empty folder with a small animation (walk.obj, walk.pc2, ...), one folder for each page
    ```console  each line after "$ " runs; the lines below must be what it prints, "..." standing for anything
    ```python   runs where the modules are that it imports; ```lua where LuaJIT is
    ```json     must be JSON; ```text is looked at by people; anything else must be marked

A comment on the line before the fence changes that:
    <!-- not run: REASON -->             which is told
    <!-- with: DECLARATIONS -->          what a fragment of C needs besides the usual handles
    <!-- no block of this page is run: REASON -->      anywhere"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from fixture import make_fixture

SOURCE, BUILD = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
PROGRAM = BUILD / "src/sphmesh"
PYTHON, LUA = SOURCE / "examples/ffi/python", SOURCE / "examples/ffi/lua"
FENCE = re.compile(r"^(?P<note><!-- (?P<word>not run|with): (?P<text>[^\n]*?) -->\n)?^```(?P<kind>\w*)[^\n]*\n(?P<body>.*?)^```$",
                   re.M | re.S)
HANDLES = ("context animation hierarchy cursor level query surface skin skeleton deformer quadric").split()
WARNINGS = "-std=gnu11 -Wall -Wextra -Werror -Wno-unused -Wno-uninitialized -Wno-maybe-uninitialized".split()
HEADERS = "".join(f"#include <{h}>\n" for h in ("math.h", "stdio.h", "stdlib.h", "string.h", "sphmesh/io.h"))


class Wrong(Exception):
    pass


class Skipped(Exception):
    pass


def environment(work):
    """As after an installation: the program, pkg-config and the loader find what was built."""
    libraries = f"{BUILD}/lib:{BUILD}/lib/io"
    return dict(os.environ, PATH=f"{work}/bin:{BUILD}/src:{BUILD}/examples:" + os.environ["PATH"], LC_ALL="C.UTF-8",
                LD_LIBRARY_PATH=libraries, PKG_CONFIG_PATH=f"{BUILD}/meson-uninstalled", PYTHONPATH=str(PYTHON),
                LUA_PATH=f"{LUA}/?.lua;{LUA}/?/init.lua;;", SPHMESH_LIBRARY_PATH=f"{BUILD}/lib",
                PYTHONDONTWRITEBYTECODE="1")


def run(command, folder, text=None):
    return subprocess.run(command, cwd=folder, env=ENVIRONMENT, input=text, stdin=None if text else subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)


def must(command, folder, text=None):
    done = run(command, folder, text)
    if done.returncode != 0:
        raise Wrong(f"exit status {done.returncode}\n{done.stdout}")
    return done.stdout


def compile_c(body, where, folder, declarations):
    if re.search(r"^int main\(", body, re.M):
        name = re.match(r"/\* (\w+\.c) \*/\n", body)
        if name:  # what a command of the page compiles later
            (folder / name[1]).write_text(body, encoding="utf-8")
        must(["cc", *WARNINGS, "-xc", "-", "-o", "block", "-pthread", *FLAGS, "-lm"], folder, f'#line {where}\n{body}')
        return must(["./block"], folder)
    parameters = ", ".join(f"sph_{h} *{h}" for h in HANDLES)
    if re.search(r"^(#include|typedef|static|struct \w+ \{)|^[\w ]+\**\w+\([^;]*\)\n\{", body, re.M):
        whole = f'{HEADERS}{declarations}\n#line {where}\n{body}'
    else:
        whole = f'{HEADERS}static void block({parameters})\n{{\n{declarations}\n{{\n#line {where}\n{body}}}\n}}\n'
    return must(["cc", *WARNINGS, "-fsyntax-only", "-xc", "-", *FLAGS], folder, whole)


def converse(body, folder):
    for command, expected in re.findall(r"^\$ (.*\n)((?:(?!\$ ).*\n)*)", body, re.M):
        done = run(["bash", "-c", command], folder)
        if expected.strip() == "" and done.returncode != 0:
            raise Wrong(f"{command}exit status {done.returncode}\n{done.stdout}")
        pattern = ".*?".join(re.escape(part) for part in expected.strip().split("..."))
        if expected.strip() and not re.fullmatch(pattern, done.stdout.strip(), re.S):
            raise Wrong(f"{command}prints\n{done.stdout}")


def run_python(body, folder):
    """With a Python that has the modules which the block imports."""
    names = [n for line in re.findall(r"^(?:import|from) ([^\n;]+)", body, re.M)
             for n in re.findall(r"(?:^|, )(\w+)", line.split(" import ")[0])]
    for python in (sys.executable, "/usr/bin/python3"):  # another one may come first on the path
        if run([python, "-c", f"import {', '.join(names or ['sys'])}"], WORK).returncode == 0:
            return must([python, "-"], folder, body)
    raise Skipped(f"no Python here has {', '.join(names)}")


def check(block, where, folder):
    kind, body, word, text = block["kind"], block["body"], block["word"], block["text"]
    if word == "not run":
        raise Skipped(text)
    if kind == "c":
        compile_c(body, where, folder, text or "")
    elif kind == "sh":
        must(["bash", "-euo", "pipefail", "-c", body], folder)
    elif kind == "console":
        converse(body, folder)
    elif kind == "python":
        run_python(body, folder)
    elif kind == "lua":
        if shutil.which("luajit") is None or not LUA.is_dir():
            raise Skipped("needs LuaJIT")
        must(["luajit", "-"], folder, body)
    elif kind == "json":
        json.loads(body)
    elif kind not in ("text", ""):
        raise Wrong(f"nothing here runs {kind}: mark it <!-- not run: WHY -->")


def main():
    loose = re.compile(r"^[ \t]+```", re.M)
    pages = [pathlib.Path(p).resolve() for p in sys.argv[3:]] or [SOURCE / "README.md", *sorted((SOURCE / "docs").rglob("*.md")),
                                                                *sorted((SOURCE / "examples").rglob("*.md"))]
    number = failures = 0
    for page in pages:
        text, folder = page.read_text(encoding="utf-8"), None
        if loose.search(text):
            sys.exit(f"{page}: an indented fence, which is not looked at")
        none = re.search(r"<!-- no block of this page is run: (.*?) -->", text)
        for block in FENCE.finditer(text):
            number += 1
            line = text.count("\n", 0, block.start("kind")) + 1
            name = f"{page.relative_to(SOURCE)}:{line} {block['kind'] or 'text'}"
            try:
                if none and block["kind"] not in ("text", ""):
                    raise Skipped(none[1])
                if folder is None:
                    folder = WORK / f"page{number}"
                    shutil.copytree(WORK / "fixture", folder)
                check(block, f'{line + 1} "{page}"', folder)
                print(f"ok {number} - {name}", flush=True)
            except Skipped as reason:
                print(f"ok {number} - {name} # SKIP {reason}", flush=True)
            except (Wrong, ValueError, subprocess.TimeoutExpired) as error:
                failures += 1
                print(f"not ok {number} - {name}\n# " + str(error).replace("\n", "\n# "), flush=True)
    print(f"1..{number}")
    return 1 if failures else 0


if __name__ == "__main__":
    WORK = pathlib.Path(tempfile.mkdtemp())
    try:
        ENVIRONMENT = environment(WORK)
        FLAGS = must(["pkg-config", "--cflags", "--libs", "sphmesh-io"], WORK).split()
        make_fixture(WORK, PROGRAM, ENVIRONMENT)
        sys.exit(main())
    finally:
        shutil.rmtree(WORK)
