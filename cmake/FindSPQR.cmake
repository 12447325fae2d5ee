# SuiteSparseQR with the CHOLMOD it stands on (libsuitesparse-dev): Debian 12 ships no CMake package of it.
# Target SPQR::SPQR.
find_path(SPQR_INCLUDE_DIR SuiteSparseQR.hpp PATH_SUFFIXES suitesparse)
find_library(SPQR_LIBRARY spqr)
find_library(SPQR_CHOLMOD_LIBRARY cholmod)
find_library(SPQR_CONFIG_LIBRARY suitesparseconfig)
mark_as_advanced(SPQR_INCLUDE_DIR SPQR_LIBRARY SPQR_CHOLMOD_LIBRARY SPQR_CONFIG_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SPQR REASON_FAILURE_MESSAGE "install libsuitesparse-dev"
  REQUIRED_VARS SPQR_LIBRARY SPQR_CHOLMOD_LIBRARY SPQR_CONFIG_LIBRARY SPQR_INCLUDE_DIR)

if(SPQR_FOUND AND NOT TARGET SPQR::SPQR)
  add_library(SPQR::SPQR UNKNOWN IMPORTED)
  set_target_properties(SPQR::SPQR PROPERTIES
    IMPORTED_LOCATION "${SPQR_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${SPQR_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${SPQR_CHOLMOD_LIBRARY};${SPQR_CONFIG_LIBRARY}")
endif()
