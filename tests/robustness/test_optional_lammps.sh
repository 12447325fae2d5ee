#!/usr/bin/env bash
# LAMMPS and MPI never stop a build that does not need them: configures a tiny project with the module of the repository, on
# machines that are made up of false wrappers, headers and libraries.
#   test_optional_lammps.sh CMAKE CXX ROOT    ROOT: the repository
set -euo pipefail

cmake=$1 cxx=$2 root=$(readlink -f "$3")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mpi="$work/mpi" lammps="$work/lammps" project="$work/project" build="$work/build"
out="$work/out"
failures=0

check() {  # check DESCRIPTION COMMAND...
  local what=$1
  shift
  "$@" || { printf 'FAILED: %s\n' "$what"; tail -n 30 "$out" | sed 's/^/    /'; failures=$((failures + 1)); }
}
status() { [[ $got == "$1" ]]; }
printed() { grep -q -- "$1" "$out"; }
silent_about() { ! grep -q -- "$1" "$out"; }
target() { "$cmake" --build "$build" --target help 2>/dev/null | grep -q "^softgrain_lammps_styles: "; }
no_target() { ! target; }

# A runtime of MPI: the programs of openmpi-bin, whose wrapper names folders that come with the headers only.
mkdir -p "$work/bin" "$project" "$lammps"
printf '#!/bin/sh\necho "mpirun (Open MPI) 4.1.4"\n' >"$work/bin/mpiexec"
cat >"$work/bin/mpicxx" <<WRAPPER
#!/bin/sh
case "\$1" in
  -showme:compile) echo "-I$mpi/include" ;;
  -showme:incdirs) echo "$mpi/include" ;;
  -showme:link) echo "-L$mpi/lib -lmpi" ;;
  -showme:libdirs) echo "$mpi/lib" ;;
  -showme:libs) echo mpi ;;
  *) exec "$cxx" -I"$mpi/include" "\$@" -L"$mpi/lib" -lmpi ;;
esac
WRAPPER
chmod +x "$work/bin/mpiexec" "$work/bin/mpicxx"
echo 'extern "C" int MPI_Init(int*, char***) { return 0; } extern "C" int MPI_Finalize() { return 0; }
extern "C" int MPI_Get_library_version(char*, int*) { return 0; }' >"$work/mpi.cpp"

install_headers() {
  mkdir -p "$mpi/include" "$mpi/lib"
  echo '#define MPI_VERSION 3
#define MPI_SUBVERSION 1
#define MPI_MAX_LIBRARY_VERSION_STRING 256
extern "C" { int MPI_Init(int*, char***); int MPI_Finalize(); int MPI_Get_library_version(char*, int*); }' >"$mpi/include/mpi.h"
  "$cxx" -shared -fPIC -o "$mpi/lib/libmpi.so" "$work/mpi.cpp"
}
remove_headers() { rm -rf "$mpi"; }
install_lammps() {
  touch "$lammps/lammps.h"
  "$cxx" -shared -fPIC -x c++ -o "$lammps/liblammps.so" /dev/null
}
remove_lammps() { rm -f "$lammps"/*; }

for folder in cmake common macrosim; do ln -s "$root/$folder" "$project/$folder"; done
cat >"$project/CMakeLists.txt" <<PROJECT
cmake_minimum_required(VERSION 3.22)
project(optional LANGUAGES CXX)
list(APPEND CMAKE_MODULE_PATH \${PROJECT_SOURCE_DIR}/cmake)
include(GNUInstallDirs)
add_library(softgrain_flags INTERFACE)
add_custom_target(softgrain)
if(BARE)
  find_package(MPI QUIET COMPONENTS CXX)
endif()
include(cmake/lammps.cmake)
PROJECT

configure() {  # configure [OPTIONS...]
  got=0
  PATH="$work/bin:$PATH" "$cmake" -G Ninja -S "$project" -B "$build" -DCMAKE_CXX_COMPILER="$cxx" -DMPIEXEC_EXECUTABLE="$work/bin/mpiexec" \
    -DCMAKE_FIND_ROOT_PATH="$lammps;$mpi" -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY \
    -DCMAKE_INCLUDE_PATH=/ -DCMAKE_LIBRARY_PATH=/ "$@" >"$out" 2>&1 || got=$?
}
build_it() { got=0; "$cmake" --build "$build" --target "$@" >"$out" 2>&1 || got=$?; }

runtime_without_headers() {
  configure
  check "a runtime without headers, and no LAMMPS: configures" status 0
  check "says what is left out and why" printed 'softgrain-lammps is left out: LAMMPS was not found'
  check "no styles of LAMMPS" no_target
  build_it softgrain
  check "the program is built" status 0
  install_lammps
  configure
  check "LAMMPS, but a runtime without headers: configures" status 0
  check "names the package that is missing" printed 'left out: MPI cannot be compiled against.*mpi-default-dev'
  check "no styles of LAMMPS" no_target
  build_it softgrain
  check "the program is built" status 0
  build_it softgrain-lammps
  check "softgrain-lammps itself is not" status 1
  check "and says why" printed 'cannot be built: MPI cannot be compiled against'
}

insisting() {
  configure -DSOFTGRAIN_LAMMPS=ON
  check "ON insists" status 1
  check "names what is missing" printed 'SOFTGRAIN_LAMMPS=ON: MPI cannot be compiled against'
  configure
  check "ON is not remembered where it could not be had" status 0
  configure -DSOFTGRAIN_LAMMPS=OFF
  check "OFF asks nobody" silent_about 'left out'
}

headers_afterwards() {
  install_headers
  configure -DSOFTGRAIN_LAMMPS=AUTO
  check "headers installed afterwards are found with the same cache" status 0
  check "and the styles of LAMMPS are there" target
  configure
  check "and stay there" target
}

uninstalled_again() {
  remove_headers
  configure
  check "headers that are uninstalled again stop nothing" status 0
  check "no styles of LAMMPS" no_target
  install_headers
  configure
  check "and heal" target
  remove_lammps
  configure
  check "LAMMPS that is uninstalled again stops nothing" status 0
  check "no styles of LAMMPS" no_target
}

stale_cache() {
  rm -rf "$build"
  install_lammps
  remove_headers
  configure -DBARE=ON
  check "FindMPI itself stops: else this test tests nothing" status 1
  configure -DBARE=OFF
  check "its cache stops nothing" status 0
  install_headers
  configure
  check "and heals" target
}

for group in runtime_without_headers insisting headers_afterwards uninstalled_again stale_cache; do
  printf -- '-- %s\n' "$group"
  "$group"
done
printf '%d failures\n' "$failures"
[[ $failures == 0 ]]
