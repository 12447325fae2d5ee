# softgrain_find_working_mpi(REASON): target MPI::MPI_CXX where MPI can be compiled against; otherwise REASON says why not.
#
# CMake's own FindMPI ends the whole configuration where a runtime is installed without its headers (openmpi-bin, which comes
# with Debian's lammps and python3-mpi4py), and keeps in the cache what it found out then, so that the headers come too late.
# So it is asked in a project of its own first, with an empty cache, and here only once it has succeeded there.

# What FindMPI found out for itself, as against what a user may have told it.
set(softgrain_mpi_found_out COMPILER_INCLUDE_DIRS ADDITIONAL_INCLUDE_DIRS ADDITIONAL_INCLUDE_VARS COMPILE_DEFINITIONS
  COMPILE_OPTIONS HEADER_DIR LIB_NAMES LINK_FLAGS)

# Whether the cache holds a finding of MPI whose folders are all still there.
function(softgrain_mpi_in_cache result)
  set(${result} OFF PARENT_SCOPE)
  if(NOT MPI_RESULT_CXX_test_mpi_normal)
    return()
  endif()
  foreach(path IN LISTS MPI_CXX_COMPILER_INCLUDE_DIRS MPI_CXX_HEADER_DIR)
    if(NOT IS_DIRECTORY "${path}")
      return()
    endif()
  endforeach()
  set(${result} ON PARENT_SCOPE)
endfunction()

function(softgrain_forget_mpi)
  get_cmake_property(names CACHE_VARIABLES)
  foreach(name IN LISTS names)
    if(name MATCHES "^MPI_(RESULT|RUN_RESULT)_CXX_" OR name MATCHES "^MPI_.*_LIBRARY$")
      unset(${name} CACHE)
    endif()
  endforeach()
  foreach(name IN LISTS softgrain_mpi_found_out)
    unset(MPI_CXX_${name} CACHE)
  endforeach()
  if(NOT EXISTS "${MPI_CXX_COMPILER}")
    unset(MPI_CXX_COMPILER CACHE)
  endif()
endfunction()

function(softgrain_probe_mpi status_variable log)
  set(probe ${PROJECT_BINARY_DIR}/CMakeFiles/mpi_probe)
  file(REMOVE_RECURSE ${probe})
  set(told)
  foreach(name CMAKE_CXX_COMPILER CMAKE_TOOLCHAIN_FILE CMAKE_PREFIX_PATH MPI_HOME MPI_CXX_COMPILER MPI_GUESS_LIBRARY_NAME
      MPI_EXECUTABLE_SUFFIX MPIEXEC_EXECUTABLE)
    if(${name})
      list(APPEND told "-D${name}=${${name}}")
    endif()
  endforeach()
  execute_process(
    COMMAND ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/mpi_probe -B ${probe} -G ${CMAKE_GENERATOR}
      "-DCMAKE_MAKE_PROGRAM=${CMAKE_MAKE_PROGRAM}" ${told}
    RESULT_VARIABLE status OUTPUT_VARIABLE said ERROR_VARIABLE said)
  file(WRITE ${log} "${said}")
  set(${status_variable} ${status} PARENT_SCOPE)
endfunction()

function(softgrain_find_working_mpi reason)
  set(${reason} "" PARENT_SCOPE)
  softgrain_mpi_in_cache(known)
  if(NOT known)
    softgrain_forget_mpi()
    set(log ${PROJECT_BINARY_DIR}/CMakeFiles/mpi_probe.log)
    softgrain_probe_mpi(status ${log})
    if(NOT status STREQUAL "0")
      set(${reason} "MPI cannot be compiled against (headers: package mpi-default-dev; what CMake says: ${log})"
        PARENT_SCOPE)
      return()
    endif()
  endif()
  find_package(MPI QUIET COMPONENTS CXX)
  if(NOT MPI_CXX_FOUND)
    set(${reason} "MPI for C++ was not found (package mpi-default-dev)" PARENT_SCOPE)
  endif()
endfunction()
