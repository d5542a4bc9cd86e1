#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs the Debian packages that building and testing need, those that are missing only.
#   scripts/setup.sh          everything that scripts/test.sh needs
#   scripts/setup.sh --demo   what scripts/demo.sh needs
#   scripts/setup.sh --docs   what scripts/docs.sh needs
#   scripts/setup.sh --heavy  what the heavy targets of docs/reliability.md need: fuzzing by AFL++, clang-tidy, valgrind, coverage
set -euo pipefail

demo_packages=(gcc libc6-dev meson ninja-build pkgconf libpng-dev)
test_packages=(
    g++ clang             # the second compiler, and C++ for what is tested against
    check                 # the test framework
    liblapacke-dev        # the oracle of lib/numeric
    libjansson-dev libopenmesh-dev # the oracles of lib/io
    libcgal-dev           # the oracle of distances to meshes
    libeigen3-dev libbullet-dev libembree-dev # what the benches compare with, besides
    valgrind              # memory that was never set
    abigail-tools cmake   # the binary interface, and a user of CMake
    python3-pytest python3-numpy python3-pycparser mypy luajit # examples/ffi
    python3 python3-yaml  # the tests of the program, and scripts/*.py
    doxygen               # the headers' documentation
)
heavy_packages=("${demo_packages[@]}" "${test_packages[@]}" afl++ clang-tidy gcovr)
docs_packages=(doxygen python3-sphinx python3-breathe python3-myst-parser groff-base python3)

case "${1-}" in
'') packages=("${demo_packages[@]}" "${test_packages[@]}") ;;
--demo) packages=("${demo_packages[@]}") ;;
--docs) packages=("${docs_packages[@]}") ;;
--heavy) packages=("${heavy_packages[@]}") ;;
*)
    echo "usage: scripts/setup.sh [--demo|--docs|--heavy]" >&2
    exit 2
    ;;
esac

installed() {
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

if ! command -v dpkg-query >/dev/null; then
    echo "setup: this is no Debian; make sure of: ${packages[*]}" >&2
    exit 0
fi

missing=()
for package in "${packages[@]}"; do
    installed "$package" || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
    echo "setup: all ${#packages[@]} packages are there"
    exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "setup: missing ${missing[*]}; neither root nor sudo to install them with" >&2
        exit 1
    fi
    as_root=(sudo)
fi

apt() {
    # Not interactive, and not waiting for ever on another apt.
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 "$@" </dev/null
}
install_missing() {
    apt install -y --no-install-recommends "${missing[@]}"
}

echo "setup: installing ${missing[*]}"
if ! compgen -G '/var/lib/apt/lists/*_Packages*' >/dev/null; then
    apt update
    install_missing
elif ! install_missing; then
    # The lists may name versions that the mirror has replaced.
    apt update
    install_missing
fi
echo "setup: done"
