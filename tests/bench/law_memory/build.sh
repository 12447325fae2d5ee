#!/usr/bin/env bash
# build.sh BUILD OUT: links the program of the folder BUILD (build/release, after a plain build) with memory.cpp as OUT.
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
root=$(readlink -f "$here/../../..")
build=$(readlink -f "$1")
out=$(readlink -m "$2")
wraps=$(grep -o '"_ZN[^"]*"' "$here/memory.cpp" | tr -d '"' | sed 's/^/-Wl,--wrap=/')
libraries=$(awk '/^build softgrain:/ {found = 1} found && /LINK_LIBRARIES/ {sub(/.*LINK_LIBRARIES = /, ""); print; exit}' "$build/build.ninja")
cd "$build"
g++ -std=c++20 -O1 -fopenmp -march=native -ffp-contract=off -DFMT_SHARED -DSPDLOG_COMPILED_LIB -DSPDLOG_FMT_EXTERNAL -DSPDLOG_SHARED_LIB \
  -I"$root" -I"$build/generated" -isystem /usr/include/hdf5/serial -c "$here/memory.cpp" -o "$out.o"
# shellcheck disable=SC2086
g++ -fopenmp $wraps CMakeFiles/softgrain.dir/pipelines/main.cpp.o "$out.o" $libraries -o "$out"
