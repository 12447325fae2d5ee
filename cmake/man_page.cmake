# Script: writes PAGE (man, section 1) from the help of PROGRAM and of each of its commands; VERSION, SCENES and DOC (folders)
# go into it. What the page says is what the program says, so that the two cannot drift apart.
cmake_minimum_required(VERSION 3.22)

# Standard output of the program as text of a page: backslashes, hyphens and leading dots lose their meaning to troff.
function(help_text variable)
  execute_process(COMMAND ${PROGRAM} ${ARGN} --help OUTPUT_VARIABLE text RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${PROGRAM} ${ARGN} --help: status ${status}")
  endif()
  string(REPLACE "\\" "\\e" text "${text}")
  string(REPLACE "-" "\\-" text "${text}")
  string(REGEX REPLACE "\n([.'])" "\n\\\\&\\1" text "${text}")
  string(STRIP "${text}" text)
  set(${variable} "${text}" PARENT_SCOPE)
endfunction()

help_text(help)
execute_process(COMMAND ${PROGRAM} --help OUTPUT_VARIABLE plain)
if(NOT plain MATCHES "Subcommands:\n(.*)\n\n")
  message(FATAL_ERROR "${PROGRAM} --help lists no commands")
endif()
string(REGEX MATCHALL "(^|\n)  [a-z][a-z-]*  " commands "${CMAKE_MATCH_1}")

set(page ".TH SOFTGRAIN 1 \"\" \"softgrain ${VERSION}\" \"User Commands\"
.SH NAME
softgrain \\- contact laws of soft particles for extremely polydisperse granular packings
.SH SYNOPSIS
.B softgrain
.I COMMAND
.RI [ OPTIONS ]
.I FILE...
.SH DESCRIPTION
.nf
${help}
.fi
.SH EXAMPLES
The whole chain on a small scene, with a report in results/quickstart:
.PP
.nf
softgrain run ${SCENES}/quickstart.toml
.fi
.SH COMMANDS
")
foreach(command IN LISTS commands)
  string(STRIP "${command}" command)
  help_text(help ${command})
  string(APPEND page ".SS softgrain ${command}\n.nf\n${help}\n.fi\n")
endforeach()
string(APPEND page ".SH FILES
.TP
.I ${SCENES}
Scenes to begin with.
.TP
.I ${DOC}
The guide (every key of every scene), results and their accuracy.
")
file(WRITE "${PAGE}" "${page}")
