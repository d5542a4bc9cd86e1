#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes a C function per public function, which calls it with arguments picked at random from what a careless caller
passes: NULL, handles, structs as initialised, zeroed or with a field set to something odd, NaN, indices that are too large.
Counts stay below what the arrays hold: that much a C interface must trust.

    make_calls.py INCLUDE_DIR OUT.c
"""
import pathlib
import re
import sys

# What cannot be called with anything but what it is for.
OWN = {"sph_context_fail": {"status": "SPH_E_IO"}, "sph_context_release": {"memory": "NULL"}, "sph_context_parallel_for": {"grain": "1 + pick(r, 3)"}}
NUMBERS = {"uint32_t": "odd_uint32(r)", "int32_t": "odd_int32(r)", "sph_status": "odd_int32(r)", "size_t": "small(r)",
           "uint64_t": "small(r)", "double": "odd_number(r)", "float": "(float)odd_number(r)", "bool": "pick(r, 2) != 0",
           "uint8_t": "(uint8_t)pick(r, 256)"}


def read_headers(folder):
    text = ""
    for header in sorted(pathlib.Path(folder, "sphmesh").glob("*.h")):
        text += re.sub(r"/\*.*?\*/", "", header.read_text(), flags=re.S)
    return text


def split_parameter(parameter):
    parameter = " ".join(parameter.split())
    match = re.match(r"^(.*?)(\w+)(\[\w*\])?$", parameter)
    kind = match[1].replace(" *", "*").strip()
    return kind + ("*" if match[3] else ""), match[2]


class Headers:
    def __init__(self, text):
        self.structs = {m[2]: m[1] for m in re.finditer(r"typedef struct \w+ \{(.*?)\n\} (\w+);", text, flags=re.S)}
        self.handles = set(re.findall(r"typedef struct (\w+) \1;", text))
        self.callbacks = {m[2]: (m[1].strip(), m[3]) for m in re.finditer(r"typedef (\w+) (\*?)(\w+)\(([^;]*)\);", text)
                          for m in [(None, m[1], m[3], m[4])]}
        self.functions = []
        for m in re.finditer(r"SPH_API\s+([^;]*?)\b(sph_\w+)\s*\(([^;]*)\)\s*;", text, flags=re.S):
            parameters = [] if m[3].strip() == "void" else [split_parameter(p) for p in m[3].split(",")]
            self.functions.append((m[1].strip(), m[2], parameters))
        fixture = pathlib.Path(__file__).with_name("calls.h").read_text()
        self.fixture = set(re.findall(r"^    sph_\w+ \*(\w+);", fixture, flags=re.M))
        self.names = {f[1] for f in self.functions}


def scalar(kind, name):
    if name.endswith("count") or name in ("size", "capacity"):
        return "small(r)"
    if "stride" in name:
        return "odd_stride(r)"
    return NUMBERS.get(kind)


def is_filled(headers, struct):
    """Plain numbers alone are made from memory."""
    return "*" in headers.structs[struct] or "struct_size" in headers.structs[struct]


def value(headers, kind, name):
    """An expression for an argument or a field, or None."""
    bare = kind.replace("const", "").replace(" ", "")
    if "*" not in bare and scalar(bare, name):
        return f"({bare}){scalar(bare, name)}"
    if bare.endswith("**") and bare[:-2] == "char":
        return "names(r)"
    if bare in headers.structs:
        return f"*fill_{bare}(r)" if is_filled(headers, bare) else None
    target = bare[:-1] if bare.endswith("*") else None
    if target == "char":
        return "text(r)"
    if target in headers.handles:
        if target[4:] not in headers.fixture:
            return "NULL"
        return f"pick(r, 8) == 0 ? NULL : fixture.{target[4:]}"
    if target in headers.callbacks or bare in headers.callbacks:
        return f"pick(r, 8) == 0 ? NULL : stub_{(target or bare)}"
    if target in headers.structs and is_filled(headers, target):
        return f"pick(r, 8) == 0 ? NULL : fill_{target}(r)"
    if target is not None:
        return "pick(r, 8) == 0 ? NULL : scratch(r)"
    return None


def fields(body):
    """(kind, name) of each field, and of each member of a pointer to a function: (None, name)."""
    for declaration in re.sub(r"#.*", "", body).split(";"):
        declaration = " ".join(declaration.split())
        if not declaration:
            continue
        pointer = re.match(r"^(.*)\(\*(\w+)\)\((.*)\)$", declaration)
        if pointer:
            yield ("function", pointer[1].strip(), pointer[3]), pointer[2]
            continue
        first, *more = declaration.split(",")
        kind, name = split_parameter(first)
        yield kind, name
        for other in more:
            yield kind.rstrip("*").strip() + ("*" if "*" in other else ""), re.sub(r"[*\s]|\[.*\]", "", other)


def write_struct(headers, name, out):
    out.append(f"static {name} *fill_{name}(uint64_t *r)\n{{\n    {name} *s = room(sizeof *s);")
    initialiser = f"{name}_init"
    assignments = []
    for kind, field in fields(headers.structs[name]):
        if isinstance(kind, tuple):
            assignments.append((field, f"stub_{name}_{field}"))
        elif field != "struct_size" and "[" not in field and not re.search(rf"\b{field}\[", headers.structs[name]):
            given = value(headers, kind, field)
            if given:
                assignments.append((field, given))
    pointers = [a for a in assignments if "stub_" in a[1] or "fixture." in a[1]]
    for field, given in pointers:  # sources, callbacks and handles are there as a rule
        out.append(f"    if (pick(r, 16) != 0) s->{field} = {given};")
    if initialiser in headers.names:
        out.append(f"    if (pick(r, 8) != 0) {initialiser}(s, sizeof *s);")
    elif "struct_size" in headers.structs[name]:
        out.append("    if (pick(r, 8) != 0) s->struct_size = sizeof *s;")
    if assignments:
        out.append(f"    for (unsigned i = pick(r, {len(assignments) + 2}); i > 0; --i) {{\n"
                   f"        switch (pick(r, {len(assignments)})) {{")
        for i, (field, given) in enumerate(assignments):
            out.append(f"        case {i}: s->{field} = {given}; break;")
        out.append("        }\n    }")
    out.append("    return s;\n}\n")


def write_stub(name, result, parameters, out):
    answer = {"void": "", "bool": "return true;", "sph_status": "return SPH_OK;"}.get(result, "return 0;")
    listed = ", ".join(" ".join(p.split()) for p in parameters.split(","))
    unused = " ".join(f"(void){split_parameter(p)[1]};" for p in parameters.split(",") if p.strip() != "void")
    if name.endswith("_parallel_for"):
        unused += " for (size_t i = 0; i < count; ++i) body(argument, i, i + 1);"
    if name.endswith("_allocate"):
        unused, answer = "(void)user;", "return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);"
    if name.endswith("_release"):
        unused += " free(memory);"
    if name.endswith("_read_frame"):
        unused += " xyz[0] = (float)frame;"
    out.append(f"static {result} stub_{name}({listed})\n{{\n    {unused}\n    {answer}\n}}\n")


def arguments_of(headers, name, parameters, out, given_by_name):
    """Declares what is passed for each parameter; the names of these, and what is to be done after the call."""
    arguments, after = [], []
    for kind, parameter in parameters:
        bare = kind.replace("const", "").replace(" ", "")
        if parameter in given_by_name:
            given = given_by_name[parameter]
        elif bare.endswith("**") and bare[:-2] in headers.handles:
            out.append(f"    {bare[:-2]} *made = NULL;\n    const bool asked = pick(r, 8) != 0;")
            given = "asked ? &made : NULL"
            after.append(f"    if (asked) CHECK((made != NULL) == (status == SPH_OK));\n    {bare[:-2]}_destroy(made);")
        elif name.endswith("_destroy"):
            given = "NULL"
        elif name.endswith("_init") and parameter == "size":
            given = f"pick(r, 3) == 0 ? sizeof({name[:-5]}) : small(r)"
        else:
            given = value(headers, kind, parameter)
        if given is None:
            sys.exit(f"{name}: no values for {kind} {parameter}")
        out.append(f"    {kind.replace('*', ' *')} {parameter}_ = {given};".replace("  ", " ").replace("\n ", "\n    "))
        arguments.append(f"{parameter}_")
    return arguments, after


def write_call(headers, result, name, parameters, out):
    out.append(f"static sph_status call_{name}(uint64_t *r)\n{{\n    (void)r; /* not all have something to pick */")
    arguments, after = arguments_of(headers, name, parameters, out, OWN.get(name, {}))
    call = f"{name}({', '.join(arguments)})"
    if result == "sph_status":
        out.append(f"    const sph_status status = {call};\n    CHECK(status >= SPH_OK);")
    elif result == "void":
        out.append(f"    {call};")
    else:
        out.append(f"    (void){call};")
    if name == "sph_context_allocate":
        out[-1] = f"    sph_context_release(context_, {call});"
    out.extend(after)
    out.append(f"    return {'status' if result == 'sph_status' else 'SPH_OK'};\n}}\n")


def handle_parameters(headers, parameters):
    """(kind, parameter) of those that take a handle."""
    for kind, parameter in parameters:
        bare = kind.replace("const", "").replace(" ", "")
        if bare.endswith("*") and bare[:-1] in headers.handles:
            yield bare[:-1][4:], parameter


def write_foreign_call(headers, result, name, parameters, parameter, out):
    """The same call with `handle` for one parameter: the status, or SPH_OK where it tells anything of what it was given."""
    out.append(f"static sph_status foreign_{name}_{parameter}(uint64_t *r, void *handle)\n{{\n    (void)r;")
    arguments, after = arguments_of(headers, name, parameters, out, {**OWN.get(name, {}), parameter: "handle"})
    call = f"{name}({', '.join(arguments)})"
    if result == "sph_status":
        out.append(f"    const sph_status status = {call};")
    elif result == "void":
        out.append(f"    const sph_status status = SPH_E_INVALID;\n    {call};")
    elif name == "sph_context_last_message":
        out.append(f"    const sph_status status = *{call} == '\\0' ? SPH_E_INVALID : SPH_OK;")
    else:
        out.append(f"    const sph_status status = {call} == 0 ? SPH_E_INVALID : SPH_OK;")
    out.extend(after)
    out.append("    return status;\n}\n")


def main(folder, target):
    headers = Headers(read_headers(folder))
    out = ["/* Made by make_calls.py from the public headers. */\n#include \"calls.h\"\n"]
    for name, (result, parameters) in headers.callbacks.items():
        write_stub(name, result, parameters, out)
    for name, body in headers.structs.items():
        for kind, field in fields(body):
            if isinstance(kind, tuple):
                write_stub(f"{name}_{field}", kind[1].replace(" *", "*").strip(), kind[2], out)
    needed = {k.replace("const", "").replace(" ", "").rstrip("*") for _, _, ps in headers.functions for k, _ in ps}
    needed |= {k.replace("const", "").replace(" ", "").rstrip("*") for name in headers.structs if name in needed
               for k, _ in fields(headers.structs[name]) if not isinstance(k, tuple)}
    for name, body in headers.structs.items():
        if name in needed and ("*" in body or "struct_size" in body):
            write_struct(headers, name, out)
    for function in headers.functions:
        write_call(headers, *function, out)
    foreign = [(*function, kind, parameter) for function in headers.functions
               for kind, parameter in handle_parameters(headers, function[2])]
    for result, name, parameters, _, parameter in foreign:
        write_foreign_call(headers, result, name, parameters, parameter, out)
    out.append("const api_foreign_call API_FOREIGN_CALLS[] = {")
    out += [f"    {{\"{name}\", \"{kind}\", {str(result == 'sph_status').lower()}, foreign_{name}_{parameter}}},"
            for result, name, _, kind, parameter in foreign]
    out.append("};\nconst size_t API_FOREIGN_CALL_COUNT = sizeof API_FOREIGN_CALLS / sizeof *API_FOREIGN_CALLS;")
    out.append("const api_call API_CALLS[] = {")
    out += [f"    {{\"{name}\", call_{name}}}," for _, name, _ in headers.functions]
    out.append("};\nconst size_t API_CALL_COUNT = sizeof API_CALLS / sizeof *API_CALLS;")
    pathlib.Path(target).write_text("\n".join(out) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
