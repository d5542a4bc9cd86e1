#!/bin/sh
# SPDX-License-Identifier: MIT
# Writes the modules that hold the headers' declarations: what `ninja ffi-declarations` runs.
#   write_declarations.sh PYTHON THIS-FOLDER INCLUDE
set -eu
for pair in python:python/sphmesh/_abi.py lua:lua/sphmesh/declarations.lua; do
    file=$2/${pair#*:}
    "$1" "$2/declarations.py" "${pair%%:*}" "$3" >"$file.new"
    mv "$file.new" "$file"
done
