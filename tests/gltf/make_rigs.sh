#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the rigs that rig_check.sh and ../blender/rig_check.sh look at, and lists them in FOLDER/rigs.json, one per line: of the
# built-in creature, and of the meshes in $SPHMESH_DATA where that is set.
#   make_rigs.sh FOLDER PROGRAM RIGS
set -euo pipefail
folder=$1 program=$2 rigs=$3 data=${SPHMESH_DATA-}
"$program" demo -o "$folder" --frame-count 12 --samples 10 --quiet
{
    "$rigs" "$folder" creature 20 "$folder/creature.obj" "$folder/creature.pc2"
    if [ -f "$data/horse-gallop.obj" ]; then
        "$rigs" "$folder" horse 34 "$data/horse-gallop.obj" "$data/horse-gallop.pc2"
    fi
    if [ -f "$data/samba.obj" ]; then "$rigs" "$folder" samba 46 "$data/samba.obj" "$data/samba.mdd"; fi
    if [ -f "$data/wolf/wolf_0.obj" ]; then "$rigs" "$folder" wolf 300 "$data/wolf/wolf_%d.obj"; fi
} >"$folder/rigs.json"
[ -n "$data" ] || echo "SPHMESH_DATA is not set: only the built-in creature is rigged"
