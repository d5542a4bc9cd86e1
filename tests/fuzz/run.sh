#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the fuzzers (clang, libFuzzer, address and undefined behaviour sanitizers) and runs each for some seconds.
#   tests/fuzz/run.sh SECONDS [TARGET...]     targets: chain file options sphm; all by default
#   tests/fuzz/run.sh afl SECONDS [TARGET...] the same with AFL++ (afl-clang-fast, afl-fuzz)
# What is found is left in build-fuzz/found; inputs that reach new code in build-fuzz/corpus. Exit 1 when something is found.
set -euo pipefail
cd "$(dirname "$0")/../.."
engine=libfuzzer
if [ "${1-}" = afl ]; then
    engine=afl
    shift
fi
if [ $# -eq 0 ]; then
    sed -n '3,6s/^# *//p' "$0" >&2
    exit 2
fi
seconds=$1
shift
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(chain file options sphm)
build=build-fuzz
[ $engine = afl ] && build=build-afl
if [ ! -d $build ]; then
    if [ $engine = afl ]; then
        AFL_USE_ASAN=1 CC=afl-clang-fast CXX=afl-clang-fast++ meson setup $build -Dfuzz=enabled -Dsimd=disabled -Dwerror=false
    else
        CC=clang CXX=clang++ meson setup $build -Dfuzz=enabled -Db_sanitize=address,undefined -Db_lundef=false \
            -Dsimd=disabled -Doptimization=1
    fi
fi
AFL_USE_ASAN=1 ninja -C $build "${targets[@]/#/tests/fuzz/fuzz_}"
mkdir -p $build/found
result=0
for target in "${targets[@]}"; do
    corpus=$build/corpus/$target
    mkdir -p "$corpus"
    if [ $engine = afl ]; then
        AFL_NO_UI=1 AFL_SKIP_CPUFREQ=1 AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES=1 afl-fuzz -V "$seconds" -m none -t 20000 \
            -i "tests/fuzz/corpus/$target" -o "$build/found/$target" "$build/tests/fuzz/fuzz_$target" || result=1
        ! compgen -G "$build/found/$target/default/crashes/id*" >/dev/null || result=1
    else
        "$build/tests/fuzz/fuzz_$target" -max_total_time="$seconds" -close_fd_mask=1 -rss_limit_mb=3000 -timeout=60 \
            -artifact_prefix="$build/found/$target-" "$corpus" "tests/fuzz/corpus/$target" || result=1
    fi
done
exit $result
