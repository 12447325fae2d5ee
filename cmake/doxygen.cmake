# Target `doxygen`, where doxygen is there: the reference of the headers in build/.../doxygen/html. Not part of a plain build.
find_package(Doxygen QUIET)
if(DOXYGEN_FOUND)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/Doxyfile.in ${PROJECT_BINARY_DIR}/Doxyfile @ONLY)
  add_custom_target(doxygen
    COMMAND ${DOXYGEN_EXECUTABLE} ${PROJECT_BINARY_DIR}/Doxyfile
    COMMENT "Writing the reference of the headers into ${PROJECT_BINARY_DIR}/doxygen/html"
    VERBATIM)
endif()
