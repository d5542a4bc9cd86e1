#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Lists the C files that clang-format would change; `scripts/format.sh --fix` changes them.
set -euo pipefail
cd "$(dirname "$0")/.."

command -v clang-format >/dev/null || {
    echo "format: clang-format is not installed (apt-get install clang-format)" >&2
    exit 1
}
mode=(--dry-run --Werror)
[ "${1-}" = --fix ] && mode=(-i)
git ls-files -z '*.c' '*.h' '*.cpp' '*.hpp' | xargs -0 -r clang-format --style=file "${mode[@]}"
