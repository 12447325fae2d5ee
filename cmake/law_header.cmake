# Script: writes HEADER, the laws of common/contact/laws.h and all that they include as one file that stands alone.
# Files keep their order of inclusion and their text; only #pragma once and the includes among them go.
cmake_minimum_required(VERSION 3.22)

# Puts the text of a file, without its includes of the tree, into `variable`, and the names of those into `includes`.
function(read_header name variable includes)
  file(READ ${SOURCE}/${name} content)
  if(NOT content MATCHES "SPDX-License-Identifier: BSD-3-Clause")
    message(FATAL_ERROR "${name}: part of the law header without the line \"SPDX-License-Identifier: BSD-3-Clause\"")
  endif()
  string(REGEX MATCHALL "#include \"[^\"\n]+\"" found "${content}")
  list(TRANSFORM found REPLACE "#include \"(.*)\"" "\\1")
  string(REGEX REPLACE "#include \"[^\"\n]+\"\n" "" content "${content}")
  string(REGEX REPLACE "#pragma once[^\n]*\n" "" content "${content}")
  set(${variable} "${content}" PARENT_SCOPE)
  set(${includes} "${found}" PARENT_SCOPE)
endfunction()

# Appends a file behind all that it includes, once.
function(append_header name)
  get_property(seen GLOBAL PROPERTY seen)
  if(name IN_LIST seen)
    return()
  endif()
  set_property(GLOBAL APPEND PROPERTY seen ${name})
  read_header(${name} content includes)
  foreach(include IN LISTS includes)
    append_header(${include})
  endforeach()
  set_property(GLOBAL APPEND_STRING PROPERTY text "\n// ---- ${name}\n${content}")
endfunction()

read_header(common/contact/laws.h about includes)
foreach(include IN LISTS includes)
  append_header(${include})
endforeach()
get_property(text GLOBAL PROPERTY text)
file(READ ${SOURCE}/common/contact/LICENSE-BSD-3-Clause licence)
string(STRIP "${licence}" licence)
string(REPLACE "\n" "\n// " licence "// ${licence}")
string(REGEX REPLACE " +\n" "\n" licence "${licence}")
string(STRIP "${about}" about)
set(text "// SPDX-License-Identifier: BSD-3-Clause
// softgrain ${VERSION}: contact laws. One file made from several headers of the project.
//
${about}
//
${licence}
#pragma once
${text}")
string(REGEX REPLACE "\n\n\n+" "\n\n" text "${text}")
file(WRITE "${HEADER}" "${text}")
