#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the program and lets it show itself: everything lands in demo-output/.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh --demo
if [ -f build-demo/build.ninja ]; then
    meson setup --reconfigure build-demo
else
    rm -rf build-demo
    meson setup build-demo --buildtype=release -Doptimization=3 -Dtests=disabled -Dprogram=enabled
fi
ninja -C build-demo src/sphmesh
build-demo/src/sphmesh demo -o demo-output "$@"

echo
echo "All files are in $PWD/demo-output; the program is build-demo/src/sphmesh."
