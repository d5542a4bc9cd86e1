#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What `ninja -C build gltf-check` runs: all .glb files of $SPHMESH_DATA against three.js, at two frame rates.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
folder=$1 bake=$2
shopt -s nullglob
files=("${SPHMESH_DATA:?is not set: the folder with the .glb files to check}"/*.glb)
[ ${#files[@]} -gt 0 ] || { echo "no .glb files in $SPHMESH_DATA" >&2; exit 1; }
"$here/setup.sh" "$folder/npm"
for fps in 30 24.7; do
    node "$here/three_check.mjs" "$folder/npm" "$bake" $fps "${files[@]}"
done
