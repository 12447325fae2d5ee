# Script: writes HEADER from SOURCE, VERSION, GIT, COMPILER, FLAGS. The commit is "unknown" when SOURCE is no repository of
# its own, when git is missing or when git refuses to read it (foreign owner); "-modified" marks uncommitted changes.
set(commit "unknown")
if(GIT AND EXISTS "${SOURCE}/.git")
  execute_process(
    COMMAND "${GIT}" -C "${SOURCE}" describe --always --abbrev=12 --exclude=* --dirty=-modified
    OUTPUT_VARIABLE described RESULT_VARIABLE status ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(status EQUAL 0 AND described)
    set(commit "${described}")
  endif()
endif()

foreach(name COMPILER FLAGS VERSION)
  string(REGEX REPLACE " +" " " ${name} "${${name}}")
  string(STRIP "${${name}}" ${name})
  string(REGEX REPLACE "([\\\\\"])" "\\\\\\1" ${name} "${${name}}")
endforeach()

set(text "// Written at build time.
#pragma once
#define SOFTGRAIN_BUILD_VERSION \"${VERSION}\"
#define SOFTGRAIN_BUILD_COMMIT \"${commit}\"
#define SOFTGRAIN_BUILD_COMPILER \"${COMPILER} ${FLAGS}\"
")
if(EXISTS "${HEADER}")
  file(READ "${HEADER}" previous)
endif()
if(NOT "${previous}" STREQUAL "${text}")
  file(WRITE "${HEADER}" "${text}")
endif()
