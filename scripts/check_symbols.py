#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compares what the two libraries export with what the headers promise, and looks at what they ask of others.

    check_symbols.py BUILD            one line per finding; exit 1 when there is one
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEADERS = ROOT / "include" / "sphmesh"
# Reached from a library, these would print, end the process, or be state that all its users share.
BANNED = {"printf", "puts", "putchar", "perror", "exit", "_exit", "_Exit", "quick_exit", "abort", "__assert_fail",
          "__printf_chk", "stdout", "stderr", "stdin", "rand", "srand", "setlocale", "atexit", "signal", "system"}
CORE_NEEDS = {"libc", "libm", "libpthread", "ld-linux-x86-64", "ld-linux-aarch64"}


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def promised(io):
    names = set()
    for header in HEADERS.glob("*.h"):
        text = re.sub(r"/\*.*?\*/", "", header.read_text(), flags=re.S)
        names |= set(re.findall(r"\bSPH_API\b[^;]*?\b(sph_\w+)\s*\(", text))
    return {name for name in names if name.startswith("sph_io_") == io}


def exported(library):
    rows = [line.split() for line in run("nm", "-D", "--defined-only", library).splitlines()]
    return {name.split("@")[0] for _, kind, name in rows if kind != "A"}


def check(library, io):
    findings = []
    names, promises = exported(library), promised(io)
    findings += [f"{library.name}: {n} is in no header" for n in sorted(names - promises)]
    findings += [f"{library.name}: {n} is in a header but not exported" for n in sorted(promises - names)]
    imports = {line.split()[-1].split("@")[0] for line in run("nm", "-D", "--undefined-only", library).splitlines()}
    findings += [f"{library.name}: uses {n}" for n in sorted(imports & BANNED)]
    needs = set(re.findall(r"\(NEEDED\).*\[(.+?)\.so", run("readelf", "-d", library)))
    if not io:
        findings += [f"{library.name}: depends on {n}" for n in sorted(needs - CORE_NEEDS)]
    return findings


def mutable_data(archive):
    """Objects that live in .data or .bss: state of the process, not of a context."""
    found = []
    for line in run("objdump", "-t", archive).splitlines():
        match = re.match(r"^[0-9a-f]+ .{7} (\.(?:data|bss|tdata|tbss)\S*)\s+([0-9a-f]+)\s+(?:\.hidden )?(\S+)$", line)
        if match and not match[1].startswith(".data.rel.ro") and int(match[2], 16) > 0 and match[3] != match[1]:
            found.append(f"{archive.name}: {match[3]} in {match[1]} can be written to")
    return found


def main(build):
    lib = pathlib.Path(build) / "lib"
    findings = []
    for name, folder, io in (("sphmesh", lib, False), ("sphmesh-io", lib / "io", True)):
        for found in (folder / f"lib{name}.so", folder / f"lib{name}.a"):
            if not found.exists():
                findings.append(f"{found.name} was not built")
        if not findings:
            findings += check(folder / f"lib{name}.so", io) + mutable_data(folder / f"lib{name}.a")
    print("\n".join(findings))
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
