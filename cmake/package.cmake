# cpack -G DEB: a package of what cmake --install puts in place. Configure with -DSOFTGRAIN_NATIVE=OFF, so that it runs on
# every machine of the architecture (preset package). Included after cmake/install.cmake.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME softgrain)
set(CPACK_PACKAGE_VENDOR "softgrain")
set(CPACK_PACKAGE_CONTACT "The softgrain authors <softgrain@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "contact laws of soft particles for extremely polydisperse packings")
set(CPACK_PACKAGE_DESCRIPTION "Resolves granular packings one decade of grain radii at a time: packs small
grains into a shell, measures how such a soft particle resists being pressed
and turned, fits a contact law, and runs larger packings with that law beside
fully resolved twins that tell the error. Contains the program, scenes to
begin with, and the contact laws as one C++ header with a CMake package.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
# Two packages: the program, and its Python package where that was built.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL softgrain)
set(CPACK_DEBIAN_SOFTGRAIN_PACKAGE_NAME softgrain)
set(CPACK_COMPONENT_SOFTGRAIN_DESCRIPTION "${CPACK_PACKAGE_DESCRIPTION}")
# The report shows packings in 3D with the JavaScript of this package, and says so when it is not there.
set(CPACK_DEBIAN_SOFTGRAIN_PACKAGE_RECOMMENDS "libjs-three")
if(softgrain_python_built)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-softgrain)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "The Python package: runs scenes and reads what they leave behind as numpy
arrays with their units, evaluates fitted contact laws at arrays of overlaps
with the very code of the simulation, and shows both in notebooks.")
  # The module is one for this version of Python alone.
  math(EXPR softgrain_next_python "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "softgrain (= ${PROJECT_VERSION}-1), python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), \
python3 (<< ${Python_VERSION_MAJOR}.${softgrain_next_python}), python3-numpy, python3-h5py")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-matplotlib")
endif()

set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian_files.cmake)
include(CPack)
