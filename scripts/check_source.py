#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What neither a compiler nor a formatter sees: banned calls, who includes whom, licence lines, long files, links.

    check_source.py calls|includes|clones|licence|length|headers|links      one line per finding; exit 1 when there is one
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# A room of lib/ may include the rooms before it. io is a library of its own and sees public headers only.
ROOMS = ["base", "numeric", "animation", "quadric", "hierarchy", "level", "coverage", "query", "measure", "surface", "skin", "skeleton", "pose", "simplify", "implicit"]
PRINTS = r"printf|vprintf|puts|putchar|perror"
ENDS = r"exit|_exit|_Exit|quick_exit|abort|assert"
SHARES = r"rand|srand|setlocale|strtok|getenv|setenv|signal|system|atexit|localtime|gmtime"
UNSAFE = r"gets|strcpy|strcat|sprintf|vsprintf|alloca"
ALLOCATES = r"malloc|calloc|realloc|free|strdup|strndup|posix_memalign|aligned_alloc"
LINES = 400


def files(*folders):
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in {".c", ".h", ".cpp", ".hpp"}:
                yield path, path.relative_to(ROOT)


def code_of(path):
    """The file without comments and string contents, lines kept."""
    def blank(match):
        text = match.group(0)
        return '""' if text[0] == '"' else "'0'" if text[0] == "'" else "\n" * text.count("\n")
    return re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', blank, path.read_text(), flags=re.S)


def calls():
    for path, name in files("lib"):
        room = name.parts[1]
        banned = rf"\b({PRINTS}|{ENDS}|{SHARES}|{UNSAFE}" + ("" if room == "base" else f"|{ALLOCATES}") + r")\s*\("
        for number, line in enumerate(code_of(path).splitlines(), 1):
            for match in re.finditer(banned + r"|\b(stdout|stderr|stdin)\b", line):
                if not re.search(r"(->|\.)\s*$", line[:match.start()]):  # a member function of the allocator's is fine
                    yield f"{name}:{number}: {match.group(1) or match.group(2)}"


def includes():
    for path, name in files("include", "lib", "src", "examples"):
        place, room = name.parts[0], name.parts[1]
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
            if not match or (match[1] == "<" and not match[2].startswith("sphmesh/")):
                continue
            quoted, target = match[1] == '"', match[2]
            where = f"{name}:{number}: includes {target}"
            if place == "lib" and quoted:
                other = target.split("/")[0] if "/" in target else room
                allowed = {"io"} if room == "io" else set(ROOMS[:ROOMS.index(room) + 1]) if room in ROOMS else {room}
                if other not in allowed:
                    yield where
            elif place == "lib" and target == "sphmesh/io.h" and room != "io":
                yield where
            elif place in ("src", "examples") and quoted and not (path.parent / target).is_file() \
                    and not (ROOT / place / target).is_file():
                yield where


def clones():
    """clang gives the resolver of a static function with clones a global name: no two may have the same."""
    seen = {}
    for path, name in files("lib"):
        for match in re.finditer(r"\bSPH__CLONES\s+static\s+[^(;]*?(\w+)\(", code_of(path)):
            if match[1] in seen:
                yield f"{name}: {match[1]} is also in {seen[match[1]]}"
            seen[match[1]] = name


def licence():
    for path, name in files("include", "lib", "src", "tests", "examples"):
        if "SPDX-License-Identifier: MIT" not in path.read_text().split("\n", 1)[0]:
            yield f"{name}: the first line is not /* SPDX-License-Identifier: MIT */"


def length():
    for path, name in files("include", "lib", "src"):
        lines = path.read_text().count("\n")
        if lines > LINES:
            yield f"{name}: {lines} lines"


def headers():
    """Every public header is installed by meson.build, and reached by sphmesh.h or the io header."""
    build = (ROOT / "meson.build").read_text()
    everything = "".join((ROOT / "include/sphmesh" / door).read_text() for door in ("sphmesh.h", "io.h"))
    for _, name in files("include"):
        if str(name) not in build:
            yield f"{name}: not installed by meson.build"
        if name.name not in ("sphmesh.h", "io.h", "export.h") and f'"{name.name}"' not in everything:
            yield f"{name}: included neither by sphmesh.h nor by io.h"


def links():
    """Every relative link of a page leads to a file of the project."""
    pages = sorted(ROOT.glob("*.md")) + sorted((ROOT / "docs").rglob("*.md"))
    for page in pages:
        for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text()):
            if "://" not in target and not target.startswith("mailto:") and not (page.parent / target).exists():
                yield f"{page.relative_to(ROOT)}: no {target}"


CHECKS = {f.__name__: f for f in (calls, includes, clones, licence, length, headers, links)}

if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1] not in CHECKS:
        sys.exit("usage: check_source.py " + "|".join(CHECKS))
    found = list(CHECKS[sys.argv[1]]())
    print("\n".join(found))
    sys.exit(1 if found else 0)
