#!/bin/sh
# SPDX-License-Identifier: MIT
# The add-on in Blender with a window, on a screen that nobody sees: what `ninja blender-addon-window-check` runs. Slow, as
# the processor draws everything.
#   addon_window.sh THIS-FOLDER LIBRARIES [PICTURE.png]      keeps a picture of the window, if it is named
set -eu
"$1/setup.sh"
if ! command -v xvfb-run >/dev/null; then
    as_root=
    [ "$(id -u)" -eq 0 ] || as_root=sudo
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends xvfb xauth libgl1-mesa-dri </dev/null
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$1/../../examples/blender/package.sh" "$1/../.." "$folder/addon.zip" "$2" >/dev/null
status=0
env -u SPHMESH_LIBRARY_PATH -u LD_LIBRARY_PATH BLENDER_USER_SCRIPTS="$folder/scripts" BLENDER_USER_CONFIG="$folder/config" \
    LIBGL_ALWAYS_SOFTWARE=1 nice xvfb-run -a -s "-screen 0 1200x760x24" timeout 500 \
    blender --factory-startup --enable-event-simulate -p 0 0 1200 760 -P "$1/addon_window.py" -- "$folder/addon.zip" \
    "$folder" >"$folder/log" 2>&1 || status=$?
grep -aE -A 20 '^(ok|FAILED)' "$folder/log" || tail -n 30 "$folder/log" >&2
[ $status -ne 0 ] || [ $# -lt 3 ] || cp "$folder/window.png" "$3"
exit $status
