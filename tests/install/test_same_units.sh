#!/usr/bin/env bash
# The same sources are compiled together on every machine: without LAMMPS, and by another compiler. Files that use the same
# names clash in one unit; if a machine puts other files together, nobody has tried whether they clash.
#   test_same_units.sh CMAKE BUILD ROOT CXX...    BUILD: a finished build of ROOT; CXX: compilers, those that are there count
set -euo pipefail

cmake=$1 build=$2 root=$(readlink -f "$3")
shift 3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

units() {  # units BUILD: each source with the unit that it is in
  (cd "$1/CMakeFiles" && grep -H '^#include' softgrain_{common,microsim,calibrate,macrosim,pipelines}.dir/Unity/*.cxx) |
    grep -v '/generated/' | sed "s|$root/||" | sort
}

compgen -G "$build/CMakeFiles/softgrain_common.dir/Unity/*.cxx" >/dev/null || { echo "nothing is compiled together here"; exit 77; }
units "$build" >"$work/expected"
[[ $(wc -l <"$work/expected") -gt 100 ]]
for compiler in "$@"; do
  "$cmake" -G Ninja -S "$root" -B "$work/build" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release -DSOFTGRAIN_TESTS=OFF \
    -DSOFTGRAIN_LAMMPS=OFF >"$work/out" 2>&1 || { tail -n 5 "$work/out"; echo "$compiler: not here, or not with everything"; continue; }
  units "$work/build" >"$work/units"
  rm -rf "$work/build"
  diff "$work/expected" "$work/units" || { echo "FAILED: without LAMMPS, by $compiler: other sources are compiled together"; exit 1; }
  echo "$compiler: the same units"
  compared=yes
done
[[ -n ${compared:-} ]]
