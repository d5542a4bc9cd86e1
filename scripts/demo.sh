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
    # Without dpkg-dev, Meson takes Debian for a system with lib64, where pkg-config and the loader do not look.
    meson setup build-demo --buildtype=release -Doptimization=3 -Dtests=disabled -Dbenches=disabled -Dprogram=enabled \
        --libdir=lib
fi
ninja -C build-demo src/sphmesh
build-demo/src/sphmesh demo -o demo-output "$@"
build-demo/src/sphmesh render demo-output/creature.obj --cache demo-output/creature.pc2 \
    demo-output/creature.sphm demo-output/creature-qem.sphm --levels 60,20 --columns 5 --size 300x240 --quiet \
    -o demo-output/levels.png

echo
echo "A picture of it is demo-output/levels.png. All files are in $PWD/demo-output; the program is build-demo/src/sphmesh."
