#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Prepares a copy of the project for Sphinx: usage pages.py FOLDER

The table of contents is docs/README.md, which is a page for readers first: each of its headings becomes a caption, the pages
that it links to become the entries. The pages of the interface come from the headers that there are."""
import pathlib
import re
import sys

top = pathlib.Path(sys.argv[1])
docs = top / "docs"
TOCTREE = "\n```{{toctree}}\n:hidden:\n:caption: {}\n\n{}\n```\n"

page = (docs / "README.md").read_text(encoding="utf-8")
listed = set()
trees = ""
for caption, body in re.findall(r"^## (.+)\n([\s\S]*?)(?=^## |\Z)", page, re.M):
    names = []
    for target in re.findall(r"\]\(([^)#]+\.md)\)", body):
        path = (docs / target).resolve()
        if path not in listed:
            listed.add(path)
            names.append("/" + str(path.relative_to(top.resolve()).with_suffix("")))
    if "interface" in caption.lower():
        names.append("/docs/interface/index")
    if names:
        trees += TOCTREE.format(caption, "\n".join(names))

missing = [p.name for p in sorted(docs.rglob("*.md")) if p.resolve() not in listed and p.name != "README.md"]
if missing:
    sys.exit(f"docs/README.md does not lead to {', '.join(missing)}")

# Links of the page are as seen from docs/; the site begins above it.
page = re.sub(r"\]\((?!https?:|#|\.\./)([^)]+)\)", r"](docs/\1)", page).replace("](../", "](")
for other in ("CONTRIBUTING.md", "NEWS.md"):
    text = (top / other).read_text(encoding="utf-8")
    (top / other).write_text(text.replace("](docs/README.md)", "](index.md)"), encoding="utf-8")
(top / "index.md").write_text(page + trees, encoding="utf-8")

interface = docs / "interface"
interface.mkdir()
entries = []
for header in sorted((top / "include/sphmesh").glob("*.h")):
    text = header.read_text(encoding="utf-8")
    if header.stem in ("sphmesh", "export"):
        continue
    brief = re.search(r"@file \S+(?:\n \* @brief)? ([^\n]+(?:\n \* [^\n@]+)*)", text)[1]
    brief = re.sub(r"\n \* ", " ", brief).removesuffix(" */")
    entries.append((header.stem, brief))
    (interface / f"{header.stem}.md").write_text(
        f"# {header.name}\n\n```{{eval-rst}}\n.. doxygenfile:: {header.name}\n```\n", encoding="utf-8")
(interface / "index.md").write_text(
    "# Headers\n\n`#include <sphmesh/sphmesh.h>` has all of the core, `#include <sphmesh/io.h>` files besides.\n\n"
    + "".join(f"* [{name}.h]({name}.md): {brief}\n" for name, brief in entries)
    + "\n```{toctree}\n:hidden:\n\n" + "\n".join(name for name, _ in entries) + "\n```\n", encoding="utf-8")
