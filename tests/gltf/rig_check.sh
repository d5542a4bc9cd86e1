#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What `ninja -C build rig-check` runs: rigs through the Khronos validator, and played by three.js.
#   rig_check.sh BUILD-FOLDER PROGRAM RIGS
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
"$here/setup.sh" "$1/npm"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$here/make_rigs.sh" "$folder" "$2" "$3"
node "$here/validate.mjs" "$1/npm" "$folder"/*-{tree,list}.glb "$folder"/*-lod*.glb "$folder"/*-root.gltf
node "$here/three_rigs.mjs" "$1/npm" "$folder/rigs.json"
