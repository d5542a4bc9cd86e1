#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Writes what other languages must know of the public headers, so that nobody types it by hand:

    declarations.py python INCLUDE   the module python/sphmesh/_abi.py: structs, callbacks, prototypes, constants for ctypes
    declarations.py lua INCLUDE      the module lua/sphmesh/declarations.lua: the declarations for ffi.cdef
    declarations.py layout INCLUDE   a C program that prints the size of every struct, and offset and size of its fields

It needs a C compiler (CC, else cc) and python3-pycparser. `ninja ffi-declarations` writes both modules anew; a test fails
when they are not what the headers say.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

from pycparser import c_ast, c_generator, c_parser

BANNER = "Written by examples/ffi/declarations.py from the public headers: do not edit, run `ninja ffi-declarations`."
BASIC = {"bool": "_Bool", "size_t": "unsigned long", "int8_t": "signed char", "uint8_t": "unsigned char",
         "int16_t": "short", "uint16_t": "unsigned short", "int32_t": "int", "uint32_t": "unsigned int",
         "int64_t": "long", "uint64_t": "unsigned long"}
CTYPES = {"bool": "c_bool", "size_t": "c_size_t", "int32_t": "c_int32", "uint32_t": "c_uint32", "int64_t": "c_int64",
          "uint64_t": "c_uint64", "uint8_t": "c_uint8", "float": "c_float", "double": "c_double", "int": "c_int",
          "void": "None", "sph_status": "c_int32"}


def preprocess(include, source, *flags):
    """`source` after the headers, preprocessed; standard headers are empty, so that only our own text comes out."""
    with tempfile.TemporaryDirectory() as folder:
        for name in ("stdint", "stddef", "stdbool"):
            pathlib.Path(folder, name + ".h").write_text("")
        command = [*os.environ.get("CC", "cc").split(), "-E", "-P", "-nostdinc", "-U__GNUC__", "-U__clang__",
                   "-DUINT32_MAX=4294967295", "-DUINT64_C(x)=x", "-I", folder, "-I", include, *flags, "-xc", "-"]
        done = subprocess.run(command, input="#include <sphmesh/io.h>\n" + source, capture_output=True, text=True)
        if done.returncode:
            sys.exit(done.stderr)
        return done.stdout


class Declarations:
    """The public headers, parsed."""

    def __init__(self, include):
        text = preprocess(include, "")
        prelude = "".join(f"typedef {real} {name};\n" for name, real in BASIC.items())
        tree = c_parser.CParser().parse(prelude + text)
        self.nodes = tree.ext[len(BASIC):]
        self.structs, self.handles, self.callbacks, self.functions, self.constants = {}, set(), {}, {}, {}
        for node in self.nodes:
            self.take(node)
        self.macros = self.read_macros(include)

    def take(self, node):
        kind = node.type
        if isinstance(node, c_ast.Typedef) and isinstance(kind, c_ast.FuncDecl):
            self.callbacks[node.name] = kind
        elif isinstance(node, c_ast.Typedef) and isinstance(kind.type, c_ast.Struct):
            if kind.type.decls is None:
                self.handles.add(node.name)
            else:
                self.structs[node.name] = kind.type.decls
        elif isinstance(kind, c_ast.FuncDecl):
            self.functions[node.name] = kind
        elif isinstance(kind, c_ast.Enum):
            value = -1
            for item in kind.values.enumerators:
                written = item.value and c_generator.CGenerator().visit(item.value).rstrip("uU")
                value = value + 1 if written is None else self.number(written)
                self.constants[item.name] = value

    @staticmethod
    def number(text):
        """The value of what consists of digits and operators only; None of anything else."""
        return eval(text, {}) if re.fullmatch(r"0x[0-9a-fA-F]+|[-\d.\s()*+<|]+", text) else None

    @classmethod
    def read_macros(cls, include):
        """{name: value} of what is defined as a number."""
        listed = preprocess(include, "", "-dM")
        names = sorted(re.findall(r"^#define (SPH_[A-Z0-9_]+) +\S", listed, flags=re.M))
        expanded = preprocess(include, "".join(f"\n@@ {name} = {name} ;" for name in names).replace("@@ SPH", "@@ _SPH"))
        values = {name: cls.number(text) for name, text in re.findall(r"@@ _(SPH_\w+) = (.*?) ;", expanded)}
        return {name: value for name, value in values.items() if value is not None}


def named(kind):
    """The name of a plain type, e.g. uint32_t."""
    return " ".join(kind.type.names) if isinstance(kind.type, c_ast.IdentifierType) else kind.type.name


class Python:
    """ctypes for the declarations. Arrays are passed by address, structs and out-parameters by reference."""

    def __init__(self, declarations):
        self.d = declarations

    def ctype(self, kind):
        if isinstance(kind, c_ast.ArrayDecl):
            return f"{self.ctype(kind.type)} * {kind.dim.value}"
        if isinstance(kind, c_ast.TypeDecl):
            name = named(kind)
            return name if name in self.d.structs else f"c.{CTYPES[name]}" if name != "void" else "None"
        target = kind.type
        if isinstance(target, c_ast.FuncDecl):
            return self.function_type(target)
        if isinstance(target, c_ast.PtrDecl):
            below = target.type
            name = named(below)
            return "c.POINTER(c.c_char_p)" if name == "char" else "c.POINTER(c.c_void_p)"
        name = named(target)
        if name == "char":
            return "c.c_char_p"
        if name in self.d.callbacks:
            return name
        return f"c.POINTER({name})" if name in self.d.structs else "c.c_void_p"

    def parameter(self, kind):
        return "c.c_void_p" if isinstance(kind, c_ast.ArrayDecl) else self.ctype(kind)

    def parameters(self, function):
        listed = [p.type for p in function.args.params] if function.args else []
        return [self.parameter(p) for p in listed if not (isinstance(p, c_ast.TypeDecl) and named(p) == "void")]

    def function_type(self, function):
        return f"c.CFUNCTYPE({', '.join([self.ctype(function.type), *self.parameters(function)])})"

    def struct(self, name, fields):
        lines = [f"class {name}(c.Structure):", "    _fields_ = ["]
        lines += [f'        ("{f.name}", {self.ctype(f.type)}),' for f in fields]
        return "\n".join(lines) + "\n    ]\n"

    def text(self):
        out = ["# SPDX-License-Identifier: MIT", f'"""{BANNER}"""', "from __future__ import annotations\n",
               "import ctypes as c", "from typing import Any, Dict, List, Tuple\n"]
        for name, value in {**self.d.constants, **self.d.macros}.items():
            out.append(f"{name} = {value!r}")
        out.append("\n")
        for node in self.d.nodes:  # in the headers' order: what is used is there before
            if node.name in self.d.callbacks:
                out.append(f"{node.name} = {self.function_type(node.type)}\n")
            elif node.name in self.d.structs:
                out.append("\n" + self.struct(node.name, self.d.structs[node.name]))
        out.append("\nSTRUCTS: List[Any] = [")
        out += [f"    {name}," for name in self.d.structs]
        out.append("]\n\nPROTOTYPES: Dict[str, Tuple[Any, List[Any]]] = {")
        for name, function in self.d.functions.items():
            out.append(f'    "{name}": ({self.ctype(function.type)}, [{", ".join(self.parameters(function))}]),')
        return "\n".join(out) + "\n}\n"


class Lua:
    """What ffi.cdef reads: the declarations as they are. Constants that are no enum go beside."""

    def __init__(self, declarations):
        self.d = declarations

    def text(self):
        generator = c_generator.CGenerator()
        lines = [generator.visit(node) + ";" for node in self.d.nodes]
        out = ["-- SPDX-License-Identifier: MIT", f"-- {BANNER}", "local declarations = {}", "declarations.cdef = [["]
        out += ["\n".join(lines) + "]]", "declarations.constants = {"]
        out += [f"  {name} = {value!r}," for name, value in self.d.macros.items()]
        out += ["}", "declarations.structs = {"] + [f'  "{name}",' for name in self.d.structs]
        return "\n".join(out) + "\n}\nreturn declarations\n"


class Layout:
    """A C program; its lines are "struct size", "struct.field offset size" and "CONSTANT value"."""

    def __init__(self, declarations):
        self.d = declarations

    def text(self):
        out = ["#include <stddef.h>", "#include <stdio.h>", "#include <sphmesh/io.h>", "int main(void)", "{"]
        for name, fields in self.d.structs.items():
            out.append(f'    printf("{name} %zu\\n", sizeof({name}));')
            for field in (f.name for f in fields):
                out.append(f'    printf("{name}.{field} %zu %zu\\n", offsetof({name}, {field}), '
                           f"sizeof((({name} *)0)->{field}));")
        for name in {**self.d.constants, **self.d.macros}:
            out.append(f'    printf("{name} %.17g\\n", (double){name});')
        return "\n".join(out) + "\n    return 0;\n}\n"


WRITERS = {"python": Python, "lua": Lua, "layout": Layout}

if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] not in WRITERS:
        sys.exit(__doc__)
    print(WRITERS[sys.argv[1]](Declarations(sys.argv[2])).text(), end="")
