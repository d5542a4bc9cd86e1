#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Looks at lib/ and src/ by other means than running them, and at what the tests run of them. Minutes each; not in CI.
#   scripts/inspect.sh tidy [FILE]...   clang-tidy, by .clang-tidy: fails at any remark
#   scripts/inspect.sh analyzer         gcc -fanalyzer over lib/: prints its remarks; docs/reliability.md says what they are
#   scripts/inspect.sh coverage         runs the tests, and prints the share of lines that they reach, by room
# scripts/setup.sh --heavy installs what this needs. Builds stay in build-inspect/.
set -euo pipefail
cd "$(dirname "$0")/.."
work=build-inspect

configure() { # NAME MESON-ARGUMENT...
    local name=$1
    shift
    [ -f "$work/$name/build.ninja" ] || meson setup "$work/$name" "$@" >/dev/null
}

sources() {
    find lib src -name '*.c' | sort
}

tidy() {
    CC=clang CXX=clang++ configure tidy -Dtests=disabled -Ddocs=disabled
    if [ $# -eq 0 ]; then
        sources
    else
        printf '%s\n' "$@"
    fi | xargs -P "$(nproc)" -n 4 clang-tidy -p "$work/tidy" --quiet
}

analyzer() {
    configure analyzer -Dtests=disabled -Dprogram=disabled -Ddocs=disabled -Dwerror=false -Dc_args=-fanalyzer
    ninja -C "$work/analyzer" clean >/dev/null
    ninja -C "$work/analyzer" | grep 'warning:' | sort -u
}

coverage() {
    configure coverage -Db_coverage=true -Dc_args=-fprofile-update=atomic -Dbenches=disabled -Ddocs=disabled
    ninja -C "$work/coverage" >/dev/null
    find "$work/coverage" -name '*.gcda' -delete
    meson test -C "$work/coverage" --no-rebuild --no-suite long --no-suite docs >"$work/coverage.log" 2>&1 ||
        grep -E 'FAIL|TIMEOUT' "$work/coverage.log" >&2
    gcovr --root . --filter 'lib/' --filter 'src/' --object-directory "$work/coverage" --json-summary-pretty \
        --output "$work/coverage.json" "$work/coverage"
    python3 scripts/coverage_by_room.py "$work/coverage.json"
}

case "${1-}" in
tidy | analyzer | coverage) "$@" ;;
*)
    echo "usage: scripts/inspect.sh tidy [FILE]... | analyzer | coverage" >&2
    exit 2
    ;;
esac
