#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The pages of docs/ and the interface, as the headers document it, as a site.
#   scripts/docs.sh [FOLDER]        makes the site; it begins at FOLDER/html/index.html (build-docs)
#   scripts/docs.sh check           only: is every public declaration documented? Needs nothing but doxygen
# Every warning is an error. scripts/setup.sh --docs installs what this needs.
set -euo pipefail
cd "$(dirname "$0")/.."

interface() { # FOLDER: the documentation of the headers as XML
    mkdir -p "$1"
    { cat docs/site/Doxyfile && echo "OUTPUT_DIRECTORY = $1"; } | doxygen -
}

if [ "${1-}" = check ]; then
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
    interface "$work"
    exit 0
fi

out=${1:-build-docs}
for tool in doxygen sphinx-build nroff; do
    if ! command -v $tool >/dev/null; then
        echo "docs: no $tool; scripts/setup.sh --docs installs it" >&2
        exit 1
    fi
done
rm -rf "$out/source" "$out/interface"
mkdir -p "$out/source"
interface "$out/interface"
# Sources in the layout of the project, so that the links of the pages lead to the same places on the site.
cp -R docs examples include tests scripts ./*.md "$out/source"
nroff -man -Tutf8 -rLL=100n docs/sphmesh.1 | sed 's/\x1b\[[0-9;]*m//g; s/.\x08//g' >"$out/source/docs/man.txt"
python3 docs/site/pages.py "$out/source"
SPHMESH_INTERFACE=$(cd "$out/interface/xml" && pwd) \
    sphinx-build -q -W --keep-going -j auto -c docs/site -d "$out/doctrees" "$out/source" "$out/html"
echo "docs: $out/html/index.html"
