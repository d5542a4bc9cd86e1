#!/bin/sh
# SPDX-License-Identifier: MIT
# The add-on in Blender without a window, from its zip, on animations of Blender's and on the program's creature. What
# `ninja blender-addon-check` runs.
#   addon_check.sh THIS-FOLDER PROGRAM LIBRARIES [PICTURE.png]      keeps the picture, if it is named
set -eu
"$1/setup.sh"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$1/../../examples/blender/package.sh" "$1/../.." "$folder/addon.zip" "$3" >/dev/null
"$2" demo --quiet --resolution 48 --frame-count 12 --samples 100 -o "$folder" >/dev/null
status=0
env -u SPHMESH_LIBRARY_PATH -u LD_LIBRARY_PATH BLENDER_USER_SCRIPTS="$folder/scripts" BLENDER_USER_CONFIG="$folder/config" \
    nice blender -b --factory-startup --python-exit-code 1 -P "$1/addon_check.py" -- "$folder/addon.zip" "$folder" \
    >"$folder/log" 2>&1 || status=$?
grep -aE '^(ok|FAILED)' "$folder/log" || tail -n 30 "$folder/log" >&2
if [ $status -ne 0 ]; then
    grep -a -A 20 '^FAILED' "$folder/log" >&2 || true
elif [ $# -gt 3 ]; then
    cp "$folder/addon.png" "$4"
fi
exit $status
