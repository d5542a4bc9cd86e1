#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the fuzzers (clang, address and undefined behaviour sanitizers) and runs each for some seconds, one after another.
#   tests/fuzz/run.sh SECONDS [TARGET...]      by libFuzzer; targets: chain file options skin sphm; all by default
#   tests/fuzz/run.sh afl SECONDS [TARGET...]  by AFL++ (the package afl++: scripts/setup.sh --heavy)
# What is found is left in build-fuzz/found (build-afl/found: TARGET/default/crashes); inputs that reach new code in
# build-fuzz/corpus (build-afl/found/TARGET/default/queue), from where they are taken up again. Exit 1 when something is found.
set -euo pipefail
cd "$(dirname "$0")/../.."
engine=libfuzzer
if [ "${1-}" = afl ]; then
    engine=afl
    shift
fi
if [ $# -eq 0 ]; then
    sed -n '3,8s/^# *//p' "$0" >&2
    exit 2
fi
seconds=$1
shift
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(chain file options skin sphm)
options=(-Dfuzz=enabled -Dsimd=disabled -Dbenches=disabled -Db_lundef=false -Doptimization=1)
build=build-fuzz
if [ $engine = afl ]; then
    build=build-afl
    export AFL_USE_ASAN=1 AFL_USE_UBSAN=1 # for its compiler, which meson knows nothing of
    [ -d $build ] || CC=afl-clang-fast CXX=afl-clang-fast++ meson setup $build "${options[@]}"
else
    export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 # what is only printed is not seen
    [ -d $build ] || CC=clang CXX=clang++ meson setup $build "${options[@]}" -Db_sanitize=address,undefined
fi
ninja -C $build "${targets[@]/#/tests/fuzz/fuzz_}"
mkdir -p $build/found
scratch=$(mktemp -d "$(test -w /dev/shm && echo /dev/shm || echo /tmp)/sphmesh-fuzz-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
export TMPDIR=$scratch # files are read and written thousands of times a second

# What AFL++ asks of its surroundings: no terminal to draw on, no core pattern, no governor of the clock, no core of its own.
export AFL_NO_UI=1 AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES=1 AFL_SKIP_CPUFREQ=1 AFL_NO_AFFINITY=1 AFL_AUTORESUME=1
export AFL_FORKSRV_INIT_TMOUT=60000
result=0
for target in "${targets[@]}"; do
    seeds=tests/fuzz/corpus/$target words=()
    if [ $engine = afl ]; then
        [ ! -f "tests/fuzz/$target.dict" ] || words=(-x "tests/fuzz/$target.dict")
        afl-fuzz -V "$seconds" -m none -t 20000 "${words[@]}" -i "$seeds" -o "$build/found/$target" \
            "$build/tests/fuzz/fuzz_$target" || result=1
        ! compgen -G "$build/found/$target/default/crashes/id*" >/dev/null || result=1
    else
        corpus=$build/corpus/$target
        mkdir -p "$corpus"
        [ ! -f "tests/fuzz/$target.dict" ] || words=("-dict=tests/fuzz/$target.dict")
        "$build/tests/fuzz/fuzz_$target" -max_total_time="$seconds" -close_fd_mask=1 -rss_limit_mb=3000 -timeout=60 \
            "${words[@]}" -artifact_prefix="$build/found/$target-" "$corpus" "$seeds" || result=1
    fi
done
exit $result
