#!/bin/sh
# SPDX-License-Identifier: MIT
# Blender imports rigs and evaluates them: its vertices must be the library's. What `ninja rig-blender-check` runs.
#   rig_check.sh THIS-FOLDER PROGRAM RIGS
set -eu
"$1/setup.sh"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$1/../gltf/make_rigs.sh" "$folder" "$2" "$3"
if ! nice blender -b --factory-startup --python-exit-code 1 -P "$1/rig_check.py" -- "$folder/rigs.json" >"$folder/log" 2>&1; then
    grep -E '^(ok|FAILED)' "$folder/log" >&2 || tail -n 30 "$folder/log" >&2
    exit 1
fi
grep '^ok' "$folder/log"
