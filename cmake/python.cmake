# The Python module softgrain._laws: the contact laws of cards and tables at numpy arrays. It never stops a build of the
# program: AUTO builds it where pybind11 and the headers of Python are there, only ON insists.
set(SOFTGRAIN_PYTHON AUTO CACHE STRING "Build the Python module (pybind11): AUTO, ON or OFF")
set_property(CACHE SOFTGRAIN_PYTHON PROPERTY STRINGS AUTO ON OFF)
set(softgrain_python_built OFF)

# Nothing to be found, only ON stops.
macro(softgrain_without_python reason)
  if(NOT SOFTGRAIN_PYTHON STREQUAL "AUTO" AND SOFTGRAIN_PYTHON)
    set_property(CACHE SOFTGRAIN_PYTHON PROPERTY VALUE AUTO)  # not remembered, so that a build without it goes on next time
    message(FATAL_ERROR "SOFTGRAIN_PYTHON=ON: ${reason}")
  endif()
  message(STATUS "The Python module is left out: ${reason}")
  # Who asks for it by name is told why there is none.
  add_custom_target(softgrain_python
    COMMAND ${CMAKE_COMMAND} -E echo "the Python module cannot be built: ${reason}"
    COMMAND ${CMAKE_COMMAND} -E false
    VERBATIM)
endmacro()

if(SOFTGRAIN_SANITIZE OR SOFTGRAIN_FUZZ)
  softgrain_without_python("sanitizers want to be in the program that loads it")
  return()
elseif(NOT SOFTGRAIN_PYTHON)
  softgrain_without_python("SOFTGRAIN_PYTHON is OFF")
  return()
endif()
# Debian's pybind11, numpy and h5py belong to the system's own Python, whatever else comes first in PATH.
if(NOT Python_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3)
endif()
find_package(Python 3.11 QUIET COMPONENTS Interpreter Development.Module)
find_package(pybind11 2.10 CONFIG QUIET)
if(NOT Python_FOUND)
  softgrain_without_python("Python 3.11 or later was not found with its headers (package python3-dev)")
  return()
elseif(NOT pybind11_FOUND)
  softgrain_without_python("pybind11 was not found (package pybind11-dev)")
  return()
endif()
set(softgrain_python_built ON)

# What the laws need of the project, compiled once more to go into a shared library. Only what is asked for is linked.
set(python_needs "")
foreach(folder common/contact common/core common/data common/io common/packing)
  file(GLOB found CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
  list(APPEND python_needs ${found})
endforeach()
list(APPEND python_needs ${PROJECT_SOURCE_DIR}/microsim/multi_contact_arrangements.cpp
  ${PROJECT_SOURCE_DIR}/pipelines/commands/complaints.cpp ${PROJECT_SOURCE_DIR}/pipelines/law/fitted_law.cpp)
add_library(softgrain_python_needs STATIC EXCLUDE_FROM_ALL ${python_needs})
target_link_libraries(softgrain_python_needs PUBLIC softgrain_flags hdf5::hdf5 fmt::fmt spdlog::spdlog
  nlohmann_json::nlohmann_json GSL::gsl ZLIB::ZLIB)
set_target_properties(softgrain_python_needs PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden)
target_include_directories(softgrain_python_needs SYSTEM PRIVATE ${VOROPP_INCLUDE_DIR})
softgrain_together(softgrain_python_needs "^(.*)/[^/]*\\.cpp$")
add_dependencies(softgrain_python_needs softgrain_build_header)

file(GLOB python_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/pipelines/python/binding/*.cpp)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # False alarms of GCC 12 on its own AVX-512 header (GCC bug 105593).
  set_source_files_properties(${python_sources} PROPERTIES COMPILE_OPTIONS "-Wno-uninitialized;-Wno-maybe-uninitialized")
endif()
Python_add_library(softgrain_python MODULE WITH_SOABI ${python_sources})
target_link_libraries(softgrain_python PRIVATE softgrain_python_needs pybind11::headers)
target_compile_definitions(softgrain_python PRIVATE JSON_DISABLE_ENUM_SERIALIZATION=1)
target_link_options(softgrain_python PRIVATE -Wl,--gc-sections -Wl,--exclude-libs,ALL)
set_target_properties(softgrain_python PROPERTIES OUTPUT_NAME _laws CXX_VISIBILITY_PRESET hidden
  LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/python/softgrain)

# Debian's Python looks here for packages of the system. A component of its own: python3-softgrain (cmake/package.cmake).
set(SOFTGRAIN_PYTHON_INSTALL_DIR lib/python3/dist-packages CACHE STRING "Where the Python package is installed, below the prefix")
install(TARGETS softgrain_python LIBRARY DESTINATION ${SOFTGRAIN_PYTHON_INSTALL_DIR}/softgrain COMPONENT python)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/pipelines/python/softgrain DESTINATION ${SOFTGRAIN_PYTHON_INSTALL_DIR} COMPONENT python
  FILES_MATCHING PATTERN "*.py" PATTERN __pycache__ EXCLUDE)
