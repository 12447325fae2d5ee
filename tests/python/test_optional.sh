#!/usr/bin/env bash
# pybind11 never stops a build that does not insist on it: configures the project on a machine that is said to have none.
# Usage: test_optional.sh CMAKE CXX_COMPILER SOURCE_DIR
set -euo pipefail
cmake=$1 compiler=$2 source=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { printf 'test_optional: %s\n' "$*" >&2; tail -n 20 "$work/log" >&2; exit 1; }
configure() {  # configure [OPTIONS...]
  "$cmake" -S "$source" -B "$work/build" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DSOFTGRAIN_TESTS=OFF -DSOFTGRAIN_LAMMPS=OFF \
    -DCMAKE_DISABLE_FIND_PACKAGE_pybind11=ON "$@" >"$work/log" 2>&1
}

configure || fail "AUTO stops where pybind11 is missing"
grep -q 'The Python module is left out: pybind11 was not found (package pybind11-dev)' "$work/log" || fail "AUTO says nothing"
! "$cmake" --build "$work/build" --target softgrain_python >"$work/log" 2>&1 || fail "a module that cannot be built was built"
grep -q 'the Python module cannot be built: pybind11 was not found' "$work/log" || fail "the target does not say why"
! configure -DSOFTGRAIN_PYTHON=ON || fail "ON does not insist"
grep -q 'SOFTGRAIN_PYTHON=ON: pybind11 was not found' "$work/log" || fail "ON does not say why"
configure || fail "ON was remembered"
configure -DSOFTGRAIN_PYTHON=OFF || fail "OFF stops"
! grep -qw '_laws\|dist-packages' "$work/build/build.ninja" || fail "OFF builds it"
