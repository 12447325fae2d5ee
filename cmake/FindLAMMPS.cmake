# Finds LAMMPS as a library with its headers: target LAMMPS::lammps. Its own CMake configuration refuses to be used where
# the program lmp is not installed beside the library, and would stop the build of everything.
# LAMMPS_INTEGERS: its sizes of integers, as it was compiled (LAMMPS_SMALLBIG, which is usual, or LAMMPS_BIGBIG).
include(FindPackageHandleStandardArgs)
foreach(name LAMMPS_INCLUDE_DIR LAMMPS_LIBRARY)  # uninstalled since: a target with paths that are gone would stop every build
  if(NOT EXISTS "${${name}}")
    unset(${name} CACHE)
  endif()
endforeach()
find_path(LAMMPS_INCLUDE_DIR lammps.h PATH_SUFFIXES lammps)
find_library(LAMMPS_LIBRARY lammps)
set(LAMMPS_INTEGERS LAMMPS_SMALLBIG CACHE STRING "Sizes of integers that LAMMPS was compiled with")
mark_as_advanced(LAMMPS_INCLUDE_DIR LAMMPS_LIBRARY LAMMPS_INTEGERS)
find_package_handle_standard_args(LAMMPS REQUIRED_VARS LAMMPS_LIBRARY LAMMPS_INCLUDE_DIR)
if(LAMMPS_FOUND AND NOT TARGET LAMMPS::lammps)
  add_library(LAMMPS::lammps UNKNOWN IMPORTED)
  set_target_properties(LAMMPS::lammps PROPERTIES
    IMPORTED_LOCATION ${LAMMPS_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${LAMMPS_INCLUDE_DIR}
    INTERFACE_COMPILE_DEFINITIONS ${LAMMPS_INTEGERS})
endif()
