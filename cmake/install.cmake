# cmake --install: the program, its manual page, the scenes with the laws they name, documentation, the law header and its
# CMake package. Included at the end of the top-level file.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(softgrain_generated ${PROJECT_BINARY_DIR}/installed)
set(softgrain_scenes ${CMAKE_INSTALL_DATADIR}/softgrain)

# The law header: all that common/contact/laws.h includes, as one file.
set(law_header ${softgrain_generated}/include/softgrain/laws.h)
file(GLOB law_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/common/contact/*.h ${PROJECT_SOURCE_DIR}/common/core/*.h)
file(MAKE_DIRECTORY ${softgrain_generated}/include/softgrain)
add_custom_command(
  OUTPUT ${law_header}
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DVERSION=${PROJECT_VERSION} -DHEADER=${law_header}
    -P ${PROJECT_SOURCE_DIR}/cmake/law_header.cmake
  DEPENDS ${law_sources} ${PROJECT_SOURCE_DIR}/cmake/law_header.cmake
    ${PROJECT_SOURCE_DIR}/common/contact/LICENSE-BSD-3-Clause
  COMMENT "Putting the law header together"
  VERBATIM)

# The manual page says what the program's own help says.
set(man_page ${softgrain_generated}/softgrain.1)
add_custom_command(
  OUTPUT ${man_page}
  COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:softgrain> -DVERSION=${PROJECT_VERSION} -DPAGE=${man_page}
    -DSCENES=${CMAKE_INSTALL_FULL_DATADIR}/softgrain/pipelines -DDOC=${CMAKE_INSTALL_FULL_DOCDIR}
    -P ${PROJECT_SOURCE_DIR}/cmake/man_page.cmake
  DEPENDS softgrain ${PROJECT_SOURCE_DIR}/cmake/man_page.cmake
  COMMENT "Writing the manual page"
  VERBATIM)
add_custom_target(softgrain_installed ALL DEPENDS ${law_header} ${man_page})

add_library(softgrain_laws INTERFACE)
set_target_properties(softgrain_laws PROPERTIES EXPORT_NAME laws)
target_compile_features(softgrain_laws INTERFACE cxx_std_20)
target_include_directories(softgrain_laws INTERFACE
  $<BUILD_INTERFACE:${softgrain_generated}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)

install(TARGETS softgrain RUNTIME)
install(TARGETS softgrain_laws EXPORT softgrain)
install(FILES ${law_header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/softgrain)
install(FILES ${man_page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)

# Nothing in the package depends on the processor.
set(package_dir ${CMAKE_INSTALL_DATADIR}/cmake/softgrain)
install(EXPORT softgrain NAMESPACE softgrain:: FILE softgrainTargets.cmake DESTINATION ${package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/softgrainConfig.cmake.in
  ${softgrain_generated}/softgrainConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${softgrain_generated}/softgrainConfigVersion.cmake
  COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES ${softgrain_generated}/softgrainConfig.cmake ${softgrain_generated}/softgrainConfigVersion.cmake
  DESTINATION ${package_dir})

# Scenes keep their place relative to the laws that they name.
file(GLOB scenes CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/pipelines/*.toml ${PROJECT_SOURCE_DIR}/pipelines/*.csv)
install(FILES ${scenes} DESTINATION ${softgrain_scenes}/pipelines)
install(FILES pipelines/grainlearning_example/soft_particle.toml
  DESTINATION ${softgrain_scenes}/pipelines/grainlearning_example)
file(GLOB examples CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/pipelines/python/*.py)
install(FILES ${examples} DESTINATION ${softgrain_scenes}/pipelines/python)
foreach(law published/law.toml law_table/law_table.toml law_table/law_table.h5 hierarchy/law_table.toml hierarchy/law_table.h5
    material_law/cell_law.toml material_law/cell_law_12.toml)
  get_filename_component(folder ${law} DIRECTORY)
  install(FILES results/${law} DESTINATION ${softgrain_scenes}/results/${folder})
endforeach()
install(FILES results/law_library/library.toml DESTINATION ${softgrain_scenes}/results/law_library OPTIONAL)

# The texts refer to each other and to pictures by their places in the tree, which they keep.
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES common/contact/LICENSE-BSD-3-Clause DESTINATION ${CMAKE_INSTALL_DOCDIR}/common/contact)
install(DIRECTORY pipelines/guide DESTINATION ${CMAKE_INSTALL_DOCDIR}/pipelines)
# Folders of results without a page are outputs of this user's runs.
install(FILES results/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/results)
file(GLOB pages RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/results/*/README.md)
foreach(page IN LISTS pages)
  get_filename_component(folder ${page} DIRECTORY)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_DOCDIR}/results
    FILES_MATCHING PATTERN "*.md" PATTERN "*.svg" PATTERN "*.png")
endforeach()
