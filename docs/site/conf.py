# SPDX-License-Identifier: MIT
"""How Sphinx makes the site; scripts/docs.sh runs it on a copy of the project (docs/site/pages.py)."""
import os
import re

project = "libsphmesh"
author = "the authors of libsphmesh"
copyright = author
with open(os.path.join(os.path.dirname(__file__), "../../include/sphmesh/version.h"), encoding="utf-8") as file:
    release = ".".join(re.findall(r"define SPH_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", file.read()))

extensions = ["breathe", "myst_parser"]
exclude_patterns = ["README.md", "docs/README.md", "tests/**"]
myst_heading_anchors = 3
breathe_projects = {"sphmesh": os.environ["SPHMESH_INTERFACE"]}
breathe_default_project = "sphmesh"
breathe_domain_by_extension = {"h": "c"}
breathe_show_include = False
primary_domain = "c"
highlight_language = "text"

html_theme = "alabaster"
html_theme_options = {"description": "animated sphere-meshes", "fixed_sidebar": True, "page_width": "72rem",
                      "sidebar_width": "15rem", "font_size": "16px"}
html_show_copyright = False
html_show_sourcelink = False
