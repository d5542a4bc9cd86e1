#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the rigs, and levels of them, that rig_check.sh and ../blender/rig_check.sh look at, and lists them in FOLDER/rigs.json, one per line: of the
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
# Levels of these rigs, alone and as a chain, posed as the library poses them (the frames of a .pc2 come after its header).
for rig in "$folder"/*-tree.glb; do
    stem=${rig%-tree.glb}
    "$program" simplify "$rig" --ratio 20,5 -o "$stem-lod.glb" --fps 24 --quiet
    "$program" pose "$stem-lod-1.glb" --fps 24 -o "$stem-lod.pc2" --json >"$stem-lod.json"
    tail -c +33 "$stem-lod.pc2" >"$stem-lod.frames"
    python3 - "$stem" "$stem-lod.json" >>"$folder/rigs.json" <<'END'
import json, sys
posed = json.load(open(sys.argv[2], encoding="utf-8"))
clips = [{"name": c["name"], "frames": c["frames"]} for c in posed["clips"]]
print(json.dumps({"rig": sys.argv[1] + "-lod-1.glb", "frames": sys.argv[1] + "-lod.frames", "fps": 24,
                  "vertices": posed["vertices"], "clips": clips}))
END
done
[ -n "$data" ] || echo "SPHMESH_DATA is not set: only the built-in creature is rigged"
