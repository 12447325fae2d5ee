# softgrain-lammps: LAMMPS with the laws of the program, under MPI. Optional, and apart from the program: it links
# nothing under GPL-3 (no GSL), and only sources that carry the BSD-3 line (tests/check_layers.py holds it to that).
find_package(MPI QUIET COMPONENTS CXX)
find_package(LAMMPS QUIET)
find_package(fmt QUIET)
if(MPI_CXX_FOUND AND TARGET LAMMPS::lammps)
  set(softgrain_lammps_found ON)
else()
  set(softgrain_lammps_found OFF)
endif()
option(SOFTGRAIN_LAMMPS "Build softgrain-lammps (LAMMPS and MPI)" ${softgrain_lammps_found})
if(NOT SOFTGRAIN_LAMMPS)
  return()
endif()
if(NOT softgrain_lammps_found)
  message(FATAL_ERROR "SOFTGRAIN_LAMMPS needs LAMMPS and MPI (packages liblammps-dev and mpi-default-bin)")
endif()

file(GLOB lammps_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/macrosim/lammps/*.cpp)
list(FILTER lammps_sources EXCLUDE REGEX "/main\\.cpp$")
add_library(softgrain_lammps_styles STATIC ${lammps_sources}
  common/contact/law_file_read.cpp common/contact/law_file_write.cpp common/io/toml_keys.cpp common/io/toml_parse.cpp)
# The shim for fmt must come before every other folder; headers of LAMMPS are not ours to warn about.
target_include_directories(softgrain_lammps_styles SYSTEM BEFORE PUBLIC ${PROJECT_SOURCE_DIR}/macrosim/lammps/fmt_shim)
target_link_libraries(softgrain_lammps_styles PUBLIC softgrain_flags LAMMPS::lammps MPI::MPI_CXX fmt::fmt)
target_compile_options(softgrain_lammps_styles PUBLIC -Wno-non-virtual-dtor)
add_executable(softgrain-lammps macrosim/lammps/main.cpp)
target_link_libraries(softgrain-lammps PRIVATE softgrain_lammps_styles)
install(TARGETS softgrain-lammps RUNTIME)
