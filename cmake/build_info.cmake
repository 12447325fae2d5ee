# Writes build/generated/softgrain_build.h (version, commit, compiler, flags) at every build; the file is touched only when
# its content changes, and one source includes it, so that an unchanged tree rebuilds nothing.
find_package(Git QUIET)

function(softgrain_add_build_header)
  get_target_property(options softgrain_flags INTERFACE_COMPILE_OPTIONS)
  list(JOIN options " " options)
  string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
  set(header ${PROJECT_BINARY_DIR}/generated/softgrain_build.h)
  add_custom_target(softgrain_build_header
    COMMAND ${CMAKE_COMMAND}
      -DHEADER=${header}
      -DSOURCE=${PROJECT_SOURCE_DIR}
      -DVERSION=${PROJECT_VERSION}
      -DGIT=${GIT_EXECUTABLE}
      "-DCOMPILER=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
      "-DFLAGS=${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}} ${OpenMP_CXX_FLAGS} ${options}"
      -P ${PROJECT_SOURCE_DIR}/cmake/build_header.cmake
    BYPRODUCTS ${header}
    COMMENT "Looking up version and commit"
    VERBATIM)
  add_dependencies(softgrain_common softgrain_build_header)
endfunction()

# The targets are declared after this file is read.
cmake_language(DEFER DIRECTORY ${PROJECT_SOURCE_DIR} CALL softgrain_add_build_header)
