#!/bin/sh
# SPDX-License-Identifier: MIT
# Packs the add-on with the Python package and the shared libraries of a build: what `ninja blender-addon` runs.
#   package.sh SOURCE-ROOT OUT.zip [FOLDER-OF-LIBRARIES]      without libraries it needs those of the system
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
root=$folder/sphmesh_blender
cp -r "$1/examples/blender/sphmesh_blender" "$root"
cp -r "$1/examples/ffi/python/sphmesh" "$root/sphmesh"
cp "$1/COPYING" "$root"
find "$root" -name __pycache__ -prune -exec rm -rf {} +
if [ $# -gt 2 ]; then
    mkdir "$root/sphmesh/lib"
    for library in "$3/libsphmesh.so.0" "$3/io/libsphmesh-io.so.0"; do
        strip --strip-unneeded -o "$root/sphmesh/lib/$(basename "$library")" "$library"
    done
fi
out=$(realpath "$(dirname "$2")")/$(basename "$2")
rm -f "$out"
(cd "$folder" && python3 -m zipfile -c "$out" sphmesh_blender)
echo "$out"
