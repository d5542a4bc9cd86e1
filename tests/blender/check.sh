#!/bin/sh
# SPDX-License-Identifier: MIT
# Blender makes an animation and writes it in every format it can; all must read as the same here.
# Called by `ninja blender-check` with the folder of this file and the program.
set -eu
"$1/setup.sh"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
if ! nice blender -b --factory-startup --python-exit-code 1 -P "$1/make.py" -- "$folder" >"$folder/log" 2>&1; then
    tail -n 30 "$folder/log" >&2
    exit 1
fi
python3 "$1/check.py" "$2" "$folder"
