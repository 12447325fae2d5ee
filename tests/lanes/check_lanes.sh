#!/usr/bin/env bash
# check_lanes.sh SOURCE COMPILER...: choosing between lanes is right under each of these compilers that is there, with
# every instruction of this machine.
set -u
source=$1; shift
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
for compiler in "$@"; do
  command -v "$compiler" > "$work/found" || { echo "$compiler: not there"; continue; }
  "$compiler" -std=c++20 -O2 -march=native -ffp-contract=off -I "$source" "$source/tests/lanes/check_lanes.cpp" -o "$work/check" || exit 1
  echo -n "$compiler: "
  "$work/check" || exit 1
done
