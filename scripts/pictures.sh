#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the pictures of README.md and docs/ anew, from nothing but the built-in creature.
# usage: scripts/pictures.sh [BUILD]       BUILD: a folder that ninja has built in; else build/ is made
set -euo pipefail
cd "$(dirname "$0")/.."

build=${1:-build}
if [ ! -f "$build/build.ninja" ]; then
    scripts/setup.sh --demo
    meson setup "$build"
fi
ninja -C "$build" src/sphmesh examples/particles examples/new_pose >/dev/null
program=$PWD/$build/src/sphmesh
particles=$PWD/$build/examples/particles
new_pose=$PWD/$build/examples/new_pose
docs=$PWD/docs
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

"$program" demo --quiet --samples 1 -o .
creature=(creature.obj --cache creature.pc2)
render() { "$program" render --quiet "$@"; }

# what a sphere-mesh is made of: a level by hand
cat >primitives.json <<'EOF'
{"format": "sphmesh-level", "version": 1, "frames": 1, "spheres": 6, "radii": [0.8, 0.7, 0.25, 0.55, 0.3, 0.12],
 "centers": [[[0, 0, 0], [2.2, -0.6, 0], [4.2, 0.7, 0], [6, -0.6, 0], [8.4, -0.7, 0], [7.2, 0.9, 0]]],
 "edges": [[1, 2]], "triangles": [[3, 4, 5]]}
EOF
render primitives.json --size 600x190 -o "$docs/primitives.png"

# the mesh, and what is left of it on the way down
render "${creature[@]}" creature.sphm --levels 2000,300,60,20,5 --size 230x180 --columns 3 --frames 6 -o "$docs/steps.png"

# a level as it is, and one that contains the mesh
"$program" level creature.sphm --spheres 40 -o plain.json --quiet
"$program" export plain.json --input creature.obj --cache creature.pc2 --conservative --save-level safe.json \
    -o capsules.json --quiet
render plain.json safe.json --overlay creature.obj --cache creature.pc2 --size 300x240 --frames 6 -o "$docs/safe.png"

# the mesh and three of its levels, the same levels within it, and levels by frames, with spheres and without
render "${creature[@]}" creature.sphm --levels 46,20,10 --size 230x190 --frames 6 -o "$docs/levels.png"
render creature.sphm --levels 46,20,10 --overlay creature.obj --cache creature.pc2 --size 300x240 --frames 6 \
    -o "$docs/overlay.png"
render creature.sphm creature-qem.sphm --levels 20 --frames ::12 --size 230x190 -o "$docs/walk.png"

# a level, and its surface as a mesh
"$program" level creature.sphm --spheres 20 -o level.json --quiet
"$program" surface level.json --resolution 96 -o surface.obj --quiet
render surface.obj level.json --size 300x240 -o "$docs/surface.png"

# particles on a level, on a simplified mesh, and on the input
for name in creature creature-qem; do
    "$program" level $name.sphm --spheres 16 -o $name.json --quiet
done
"$particles" creature.json creature-qem.json "${creature[0]}" creature.pc2 "$docs/particles.png"

# a pose that the animation does not have, made by moving spheres
"$new_pose" creature.obj creature.pc2 posed.obj posed.json
render posed.obj posed.json --size 300x240 -o "$docs/new_pose.png"

# a rig: its weights, and the input and the reconstruction in the frame where they differ most
worst=$("$program" skin "${creature[@]}" --spheres 22 -o rig.glb --json --quiet | sed -n 's/^  "max_frame": *\([0-9]*\).*/\1/p')
render "${creature[@]}" --bones rig.glb --size 300x240 --frames 7:32:12 -o "$docs/bones.png"
render "${creature[@]}" --size 300x240 --frames "$worst" -o "$docs/rig-input.png"
render rig.glb --size 300x240 --frames "$worst" -o "$docs/rig.png"

# the rig and three of its levels, each in three poses
"$program" simplify rig.glb --ratio 10,3,1 -o lod.glb --quiet
for level in 0 1 2 3; do
    name=lod-$level.glb
    [ "$level" -gt 0 ] || name=rig.glb
    render "$name" --size 230x180 --frames 0:36:12 --flat -o "$docs/simplify-$level.png"
done

# one pose of the rig, blended linearly and corrected by implicit skinning; its operators
"$program" pose rig.glb --frames 20:21 --implicit --beside -o soft.pc2 --quiet
render soft-lbs.obj --size 380x300 --flat -o "$docs/implicit-lbs.png"
render soft.obj --size 380x300 --flat -o "$docs/implicit-ours.png"
python3 "$docs/../scripts/plot_implicit.py" "$(dirname "$program")/../lib/libsphmesh.so" "$docs/implicit-operators.png"
