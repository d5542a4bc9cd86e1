#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds and tests everything in all configurations; the last line says "N passed, N failed".
#   scripts/test.sh                      all
#   scripts/test.sh gcc clang sanitize threads portable install source     some
# A case counts once for each configuration that runs it. Logs stay in build-test/.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1

top=$PWD
work=$top/build-test
jobs=$(nproc)
passed=0
failed=0
skipped=0
started=$SECONDS

say() { printf '\n== %s  [%d s]\n' "$1" $((SECONDS - started)); }

# check NAME COMMAND...: one check of our own; what it prints is shown when it fails.
check() {
    local name=$1 log=$work/check.log
    shift
    if "$@" >"$log" 2>&1; then
        passed=$((passed + 1))
        echo "ok      $name"
    else
        failed=$((failed + 1))
        echo "FAILED  $name"
        grep -v '^$' "$log" | tail -n 40 | sed 's/^/        /'
    fi
}

wanted() {
    [ ${#only[@]} -eq 0 ] && return 0
    local name
    for name in "${only[@]}"; do [ "$name" = "$1" ] && return 0; done
    return 1
}

# build NAME MESON-ARGUMENT...: sets up and compiles build-test/NAME. Failing counts as one failure.
build() {
    local name=$1 log=$work/$1.log
    shift
    rm -rf "${work:?}/$name"
    if meson setup "$work/$name" -Dtests=enabled -Dprogram=enabled "$@" >"$log" 2>&1 &&
        ninja -C "$work/$name" -j "$jobs" >>"$log" 2>&1; then
        passed=$((passed + 1))
        echo "ok      $name builds"
        return 0
    fi
    failed=$((failed + 1))
    echo "FAILED  $name builds"
    tail -n 40 "$log" | sed 's/^/        /'
    return 1
}

# run NAME MESON-TEST-ARGUMENT...: runs the tests of build-test/NAME and counts their cases.
run() {
    local name=$1 dir=$work/$1 log=$work/$1-tests.log counts p f s
    shift
    rm -rf "$dir"/meson-logs/testlog*
    meson test -C "$dir" --no-rebuild --num-processes "$jobs" "$@" >"$log" 2>&1 </dev/null
    if ! counts=$(python3 scripts/count_tests.py "$dir" 2>>"$log"); then
        failed=$((failed + 1))
        echo "FAILED  $name: the tests cannot be counted"
        tail -n 40 "$log" | sed 's/^/        /'
        return
    fi
    read -r p f s <<<"$(head -n 1 <<<"$counts")"
    passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
    printf '%-7s %s: %d passed, %d failed, %d skipped\n' "$([ "$f" -eq 0 ] && echo ok || echo FAILED)" "$name" "$p" "$f" "$s"
    tail -n +2 <<<"$counts" | grep . | sed 's/^/        /'
    if [ "$f" -gt 0 ]; then
        grep -aE 'not ok|ERROR: |runtime error|WARNING: ThreadSanitizer|SUMMARY|Assertion' "$dir/meson-logs/testlog.txt" |
            sort | uniq -c | head -n 40 | sed 's/^/        /'
    fi
}

# headers COMPILER...: each public header alone, twice in one file.
headers_stand_alone() {
    local header result=0
    for header in include/sphmesh/*.h; do
        printf '#include <sphmesh/%s>\n#include <sphmesh/%s>\nint main(void);\n' "${header##*/}" "${header##*/}" |
            "$@" -Wall -Wextra -Werror -pedantic -fsyntax-only -Iinclude - || result=1
    done
    return $result
}

# consumer KIND SOURCE PACKAGE [FLAG...]: compiles against the staged install by pkg-config alone, and runs.
consumer() {
    local kind=$1 source=$2 package=$3 stage=$work/stage-$1 out needs flags=() options=()
    out=$work/consumer-$kind-$(basename "$source" | tr . -)
    shift 3
    local compiler=(gcc -std=c11)
    [ "${source##*.}" = cpp ] && compiler=(g++ -std=c++17)
    [ "$kind" = static ] && options=(--static)
    export PKG_CONFIG_SYSROOT_DIR=$stage PKG_CONFIG_PATH=$stage/usr/lib/pkgconfig
    read -r -a flags <<<"$(pkg-config "${options[@]}" --cflags --libs "$package")"
    unset PKG_CONFIG_SYSROOT_DIR PKG_CONFIG_PATH
    echo "${flags[*]}"
    "${compiler[@]}" -Wall -Wextra -Werror -o "$out" "$source" "${flags[@]}" "$@" || return 1
    needs=$(LD_LIBRARY_PATH=$stage/usr/lib ldd "$out") || return 1
    case $kind,$needs in
    shared,*libsphmesh.so.0*) ;;
    shared,* | static,*sphmesh*) echo "$needs" && return 1 ;;
    esac
    read -r -a options <<<"${arguments-}"
    (cd "$work/walk" && LD_LIBRARY_PATH=$stage/usr/lib "$out" "${options[@]}" </dev/null)
}

# examples KIND: all of examples/ that are one file, against the staged install, on the creature.
examples() {
    local source arguments result=0
    for source in examples/*.c; do
        case ${source##*/} in
        particles*) continue ;; # of several files, with libpng
        host.c) arguments="walk.obj walk.pc2 host.sphm" ;;
        lod_browser.c) arguments=creature.sphm ;;
        game_loop.c) arguments=level-20.json ;;
        bend_rig.c) arguments="creature-rig.glb 3 60 bent.obj" ;;
        pose_loop.c) arguments="creature-rig.glb 0.2" ;;
        rig_export.c) arguments="walk.obj walk.pc2 rig.glb capsules.json" ;;
        new_pose.c) arguments="walk.obj walk.pc2 posed.obj posed.json" ;;
        *) arguments='' ;;
        esac
        consumer "$1" "$source" sphmesh-io -lm -pthread || { echo "$source failed" && result=1; }
    done
    return $result
}

# consumer_of_cmake KIND: configures and builds against the staged install by find_package alone, and runs.
consumer_of_cmake() {
    local stage=$work/stage-$1 out=$work/cmake-$1
    rm -rf "$out"
    cmake -S tests/install/cmake -B "$out" -DCMAKE_PREFIX_PATH="$stage/usr" && cmake --build "$out" || return 1
    (cd "$work/walk" && LD_LIBRARY_PATH=$stage/usr/lib "$out/consumer")
}

# The Python package, with nothing but the loader's own search, in the first Python that has NumPy.
python_finds() {
    local python
    for python in python3 /usr/bin/python3; do
        $python -c 'import numpy' 2>/dev/null && break
    done
    LD_LIBRARY_PATH=$work/stage-shared/usr/lib PYTHONPATH=examples/ffi/python PYTHONDONTWRITEBYTECODE=1 $python -c \
        'import sphmesh; sphmesh.Level([[0, 0, 0]], [1]).save("'"$work"'/one.json"); print(sphmesh.library_version())'
}

# An animation to try things on: walk.obj and walk.pc2, in a folder of their own.
make_walk() {
    rm -rf "$work/walk"
    "$work/release/src/sphmesh" demo --quiet --resolution 32 --frame-count 6 --samples 100 -o "$work/walk" &&
        mv "$work/walk/creature.obj" "$work/walk/walk.obj" && mv "$work/walk/creature.pc2" "$work/walk/walk.pc2"
}

# The two commands of README.md.
readme_commands() (
    cd "$work/walk" || exit 1
    PATH=$work/release/src:$PATH
    while read -r command; do
        echo "$command"
        eval "$command" </dev/null || exit 1
    done < <(sed -n '/^## With an animation/,/^## /s/^sphmesh /sphmesh /p' "$top/README.md")
    [ -s walk40.json ] && grep -q '"spheres": *40' walk40.json
)

# same_bits BUILD...: what the demo writes is the same, byte for byte, from every build and for any number of threads.
same_bits() {
    local name threads first='' out
    rm -rf "$work/same"
    mkdir "$work/same"
    for name in "$@"; do
        for threads in 1 2 5; do
            out=$work/same/$name-$threads
            "$work/$name/src/sphmesh" demo --quiet --resolution 32 --frame-count 6 --samples 100 \
                --threads $threads -o "$out" || return 1
            diff -rq "${first:=$out}" "$out" || return 1
        done
    done
}

# What the sanitizers do not see, in a few programs: values that nobody has set. And what a new processor does not run: there is
# no AVX-512 here, so the golden hashes are those of the next best vectors.
valgrind_finds_nothing() {
    local program
    for program in unit/test_animation unit/test_golden unit/test_skin_arrays unit/test_level_arrays unit/test_query \
        io/test_io_obj io/test_io_gltf io/test_io_alembic io/test_io_cache; do
        CK_FORK=no SPH_FIXTURES=$top/tests/io/fixtures valgrind -q --error-exitcode=9 --leak-check=no \
            "$work/gcc/tests/$program" || return 1
    done
}

# bench_runs NAME: once as text, once as JSON that is one.
bench_runs() {
    "$work/gcc/tests/bench/$1" --tiny &&
        "$work/gcc/tests/bench/$1" --tiny --json >"$work/$1.json" &&
        python3 -m json.tool "$work/$1.json" >/dev/null
}

# stage KIND: an installed tree with the shared libraries only, or the static ones only.
stage() {
    rm -rf "${work:?}/stage-$1"
    meson install -C "$work/release" --no-rebuild --destdir "$work/stage-$1" || return 1
    if [ "$1" = static ]; then rm "$work/stage-$1"/usr/lib/*.so*; else rm "$work/stage-$1"/usr/lib/*.a; fi
}

only=("$@")
mkdir -p "$work"
export CI=${CI-true}

say "setup"
check "the packages are there" scripts/setup.sh

if wanted source; then
    say "source"
    check "lib/ calls nothing that prints, ends the process or allocates past the context" scripts/check_source.py calls
    check "includes point one way" scripts/check_source.py includes
    check "kernels with clones have names of their own" scripts/check_source.py clones
    check "every file names its licence" scripts/check_source.py licence
    check "every public header is installed" scripts/check_source.py headers
    check "every link of the documentation leads somewhere" scripts/check_source.py links
    check "every public declaration is documented" scripts/docs.sh check
    command -v sphinx-build >/dev/null && check "the site builds without a warning" scripts/docs.sh "$work/site"
    check "headers stand alone as C11 (gcc)" headers_stand_alone gcc -std=c11 -xc
    check "headers stand alone as C11 (clang)" headers_stand_alone clang -std=c11 -xc
    check "headers stand alone as C++11 (gcc)" headers_stand_alone g++ -std=c++11 -xc++
    check "headers stand alone as C++20 (clang)" headers_stand_alone clang++ -std=c++20 -xc++
    scripts/check_source.py length | grep . | sed 's/^/warning: longer than 400 lines: /'
fi

if wanted gcc; then
    say "gcc"
    build gcc && run gcc
    check "valgrind sees no use of memory that was never set" valgrind_finds_nothing
    check "the binary interface is the reviewed one" tests/abi/check_abi.sh check "$work/gcc"
fi

if wanted clang; then
    say "clang"
    CC=clang CXX=clang++ build clang && run clang --no-suite careless --no-suite interrupt --no-suite long --no-suite docs --no-suite ffi
fi

if wanted portable; then
    say "portable: without vector kernels, release optimisation, assertions of the tests on"
    build portable -Dsimd=disabled -Doptimization=3 -Dbenches=disabled &&
        run portable --no-suite careless --no-suite io --no-suite cli --no-suite long --no-suite docs --no-suite ffi
fi

if wanted gcc; then
    say "benches, once, on tiny input"
    for name in bench_build bench_query; do
        check "$name runs" bench_runs $name
    done
fi

if wanted gcc && wanted clang && wanted portable; then
    check "every build and any number of threads give the same bits" same_bits gcc clang portable
fi

if wanted sanitize; then
    say "address and undefined behaviour sanitizers"
    export ASAN_OPTIONS=abort_on_error=0:allocator_may_return_null=1
    export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
    export CK_FORK=no # one search for leaks per program, not per test: it takes longer than most tests
    build sanitize -Dbenches=disabled -Dhandle-checks=enabled -Db_sanitize=address,undefined -Db_lundef=false -Doptimization=1 &&
        run sanitize --timeout-multiplier 4 --no-suite interrupt --no-suite long --no-suite reference --no-suite docs
fi

if wanted threads; then
    say "thread sanitizer"
    export TSAN_OPTIONS=halt_on_error=1:second_deadlock_stack=1
    if build threads -Dbenches=disabled -Db_sanitize=thread -Db_lundef=false -Doptimization=1; then
        run threads --timeout-multiplier 4 --suite threads
        check "the program's threads do not race" "$work/threads/src/sphmesh" demo --quiet --resolution 32 \
            --frame-count 4 --samples 100 --threads 4 -o "$work/race"
    fi
fi

if wanted install; then
    say "installed"
    if build release -Dbuildtype=release -Doptimization=3 --prefix=/usr --libdir=lib -Dtests=disabled; then
        check "the libraries export what the headers say, and share no state" scripts/check_symbols.py "$work/release"
        check "the program makes its demo" make_walk
        check "the commands of README.md work" readme_commands
        awk '/^```c$/ { on = 1; next } /^```/ { on = 0 } on' README.md >"$work/readme.c"
        for kind in shared static; do
            check "$kind libraries install" stage $kind
            check "a C program finds the $kind libraries" consumer $kind tests/install/consumer.c sphmesh-io
            check "an example builds with the $kind core" consumer $kind examples/first_steps.c sphmesh -lm
            [ $kind = shared ] && check "all examples build and run with the installed libraries" examples $kind
            check "the program of README.md runs ($kind)" consumer $kind "$work/readme.c" sphmesh-io
            check "CMake finds the $kind libraries" consumer_of_cmake $kind
            [ $kind = static ] || check "the Python package finds the shared libraries" python_finds
            check "a C++ program finds the $kind core" consumer $kind tests/install/consumer.cpp sphmesh
        done
    fi
fi

printf '\n%d skipped, %d s\n' "$skipped" $((SECONDS - started))
printf '%d passed, %d failed\n' "$passed" "$failed"
[ "$failed" -eq 0 ]
