# Run by cpack between installing into its staging folders, one per package, and packing: what Debian's policy wants beside the
# files, and only a Debian package: the licences in one file, a changelog, compressed pages.
set(gpl "License: GPL-3+
 This program is free software: you can redistribute it and/or modify it under the terms of the GNU General Public License
 as published by the Free Software Foundation, either version 3 of the License, or (at your option) any later version.
 .
 On Debian systems the full text is in /usr/share/common-licenses/GPL-3.
")

# copyright and changelog.Debian.gz of a package; `more` follows in the copyright file.
function(write_debian_files doc package more)
  file(WRITE ${doc}/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: softgrain

Files: *
Copyright: 2026 the softgrain authors
${gpl}${more}")
  execute_process(COMMAND date -R OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE)
  file(WRITE ${doc}/changelog.Debian "${package} (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * Package of version ${CPACK_PACKAGE_VERSION}; changes are in changelog.gz of softgrain.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
  execute_process(COMMAND gzip -9n -f ${doc}/changelog.Debian COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/softgrain)
set(doc ${root}/usr/share/doc/softgrain)
file(REMOVE ${doc}/LICENSE)  # stands in /usr/share/common-licenses
file(READ ${doc}/common/contact/LICENSE-BSD-3-Clause bsd)
string(REGEX REPLACE "^.*(Redistribution and use)" "\\1" bsd "${bsd}")
string(STRIP "${bsd}" bsd)
string(REPLACE "\n\n" "\n.\n" bsd "${bsd}")
string(REPLACE "\n" "\n " bsd "${bsd}")
write_debian_files(${doc} softgrain "
Files: usr/include/softgrain/laws.h
Copyright: 2026 the softgrain authors
License: BSD-3-clause
 ${bsd}
")
file(RENAME ${doc}/CHANGELOG.md ${doc}/changelog)  # the name that Debian looks for
execute_process(COMMAND gzip -9n -f ${doc}/changelog ${root}/usr/share/man/man1/softgrain.1 COMMAND_ERROR_IS_FATAL ANY)

set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/python)
if(EXISTS ${root})
  write_debian_files(${root}/usr/share/doc/python3-softgrain python3-softgrain "")
endif()
