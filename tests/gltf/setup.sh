#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs what the checks of glTF need (three.js, the Khronos validator) into FOLDER by npm, with these exact versions.
#   tests/gltf/setup.sh FOLDER
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
folder=${1:?usage: setup.sh FOLDER}
command -v npm >/dev/null || { echo "setup: npm is not installed" >&2; exit 1; }
mkdir -p "$folder"
cp "$here/package.json" "$here/package-lock.json" "$folder/"
cd "$folder"
[ -d node_modules/three ] && cmp -s package-lock.json .installed && exit 0
npm ci --no-audit --no-fund --ignore-scripts
cp package-lock.json .installed
