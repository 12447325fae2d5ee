# Several sources in one compilation: less than half the time from nothing, as most of it goes into reading the same
# headers again and again. Names of an unnamed namespace must then be unique within a group, not only within a file: the
# compiler says where they are not. Sources with options of their own stay alone (CMake sees to it).
option(SOFTGRAIN_TOGETHER "Compile the sources of a folder together" ON)

# The group of a source is the part in brackets of what the regular expression matches of its path in the project.
function(softgrain_together target expression)
  if(NOT SOFTGRAIN_TOGETHER)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    file(RELATIVE_PATH path ${PROJECT_SOURCE_DIR} ${source})
    if(path MATCHES "${expression}")
      string(MAKE_C_IDENTIFIER "${CMAKE_MATCH_1}" group)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()
