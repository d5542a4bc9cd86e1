#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Compares the binary interface of the shared libraries with the reviewed baseline beside this script.
#   check_abi.sh check BUILD     fails on any difference, also on what is only added
#   check_abi.sh accept BUILD    makes what is now the baseline
# The libraries must have been compiled with debug information.
set -uo pipefail
here=$(cd "$(dirname "$0")" && pwd)
headers=$here/../../include
build=$2
result=0

# What is behind the handles is nobody's business: abidiff goes by the names of files, and the rooms of the library have
# headers of the same names as the public ones.
private=$(mktemp)
trap 'rm -f "$private"' EXIT
{
    sed -nE 's/^typedef struct (\w+) \1;.*/\1/p' "$headers"/sphmesh/*.h
    echo 'sph__\w+'
} | paste -sd '|' | sed 's/.*/[suppress_type]\n  name_regexp = ^(struct )?(&)$/' >"$private"

for library in "$build/lib/libsphmesh.so" "$build/lib/io/libsphmesh-io.so"; do
    baseline=$here/$(basename "$library" .so).abi
    case $1 in
    accept)
        # Where types are declared stays in: without it abidiff takes them all for private and sees no change.
        abidw --headers-dir "$headers" --drop-private-types --no-corpus-path --no-comp-dir-path \
            --out-file "$baseline" "$library" || result=1
        ;;
    check)
        # 4: changed, 8: in a way that breaks callers for sure. Either is for a person to look at.
        if ! abidiff --suppressions "$private" --headers-dir1 "$headers" --headers-dir2 "$headers" "$baseline" "$library"; then
            echo "$(basename "$library") differs from its baseline; where that is meant: ninja abi-accept"
            result=1
        fi
        ;;
    *)
        echo "usage: check_abi.sh check|accept BUILD" >&2
        exit 2
        ;;
    esac
done
exit $result
