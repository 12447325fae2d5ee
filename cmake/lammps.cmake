# softgrain-lammps: LAMMPS with the laws of the program, under MPI. Optional, and apart from the program: it links
# nothing under GPL-3 (no GSL), and only sources that carry the BSD-3 line (tests/check_layers.py holds it to that).
# It never stops a build of the program: AUTO builds it where LAMMPS and MPI are there, only ON insists.
set(SOFTGRAIN_LAMMPS AUTO CACHE STRING "Build softgrain-lammps (LAMMPS and MPI): AUTO, ON or OFF")
set_property(CACHE SOFTGRAIN_LAMMPS PROPERTY STRINGS AUTO ON OFF)
set(softgrain_lammps_built OFF)
# The sources of common that the styles take along stay single: whoever links both takes each once. Without LAMMPS too,
# so that the same sources are compiled together on every machine (tests/install/test_same_units.sh).
set(lammps_common common/contact/law_file_read.cpp common/contact/law_file_write.cpp common/io/toml_parse.cpp)
set_source_files_properties(${lammps_common} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
if(NOT SOFTGRAIN_LAMMPS)
  return()
endif()

include(${CMAKE_CURRENT_LIST_DIR}/working_mpi.cmake)
find_package(LAMMPS QUIET)
find_package(fmt QUIET)
set(softgrain_lammps_missing "")
if(NOT TARGET LAMMPS::lammps)
  set(softgrain_lammps_missing "LAMMPS was not found as a library with its headers (package liblammps-dev)")
else()
  softgrain_find_working_mpi(softgrain_lammps_missing)
endif()
if(softgrain_lammps_missing)
  if(NOT SOFTGRAIN_LAMMPS STREQUAL "AUTO")
    # Not remembered, so that a build without it goes on next time.
    set_property(CACHE SOFTGRAIN_LAMMPS PROPERTY VALUE AUTO)
    message(FATAL_ERROR "SOFTGRAIN_LAMMPS=ON: ${softgrain_lammps_missing}")
  endif()
  message(STATUS "softgrain-lammps is left out: ${softgrain_lammps_missing}")
  # Who asks for it by name is told why there is none.
  add_custom_target(softgrain-lammps
    COMMAND ${CMAKE_COMMAND} -E echo "softgrain-lammps cannot be built: ${softgrain_lammps_missing}"
    COMMAND ${CMAKE_COMMAND} -E false
    VERBATIM)
  return()
endif()
set(softgrain_lammps_built ON)

file(GLOB lammps_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/macrosim/lammps/*.cpp)
list(FILTER lammps_sources EXCLUDE REGEX "/main\\.cpp$")
add_library(softgrain_lammps_styles STATIC ${lammps_sources} ${lammps_common})
# The shim for fmt must come before every other folder; headers of LAMMPS are not ours to warn about.
target_include_directories(softgrain_lammps_styles SYSTEM BEFORE PUBLIC ${PROJECT_SOURCE_DIR}/macrosim/lammps/fmt_shim)
target_link_libraries(softgrain_lammps_styles PUBLIC softgrain_flags LAMMPS::lammps MPI::MPI_CXX fmt::fmt)
target_compile_options(softgrain_lammps_styles PUBLIC -Wno-non-virtual-dtor)
add_executable(softgrain-lammps macrosim/lammps/main.cpp)
target_link_libraries(softgrain-lammps PRIVATE softgrain_lammps_styles)
install(TARGETS softgrain-lammps RUNTIME)
