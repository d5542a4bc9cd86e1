#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs Blender and what its exporter of glTF needs, unless they are there: some 700 MB.
set -eu
if command -v blender >/dev/null && dpkg-query -W python3-numpy >/dev/null 2>&1; then
    echo "setup: Blender is there"
    exit 0
fi
as_root=
[ "$(id -u)" -eq 0 ] || as_root=sudo
$as_root env DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends blender python3-numpy </dev/null
