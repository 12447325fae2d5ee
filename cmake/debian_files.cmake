# Run by cpack between installing into its staging folder and packing: what Debian's policy wants beside the program, and
# only a Debian package: the licences in one file, a changelog, compressed pages.
foreach(root IN LISTS CPACK_TEMPORARY_INSTALL_DIRECTORY)
  set(doc ${root}/usr/share/doc/softgrain)
  file(REMOVE ${doc}/LICENSE)  # stands in /usr/share/common-licenses
  file(READ ${doc}/common/contact/LICENSE-BSD-3-Clause bsd)
  string(REGEX REPLACE "^.*(Redistribution and use)" "\\1" bsd "${bsd}")
  string(STRIP "${bsd}" bsd)
  string(REPLACE "\n\n" "\n.\n" bsd "${bsd}")
  string(REPLACE "\n" "\n " bsd "${bsd}")
  file(WRITE ${doc}/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: softgrain

Files: *
Copyright: 2026 the softgrain authors
License: GPL-3+
 This program is free software: you can redistribute it and/or modify it under the terms of the GNU General Public License
 as published by the Free Software Foundation, either version 3 of the License, or (at your option) any later version.
 .
 On Debian systems the full text is in /usr/share/common-licenses/GPL-3.

Files: usr/include/softgrain/laws.h
Copyright: 2026 the softgrain authors
License: BSD-3-clause
 ${bsd}
")
  execute_process(COMMAND date -R OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE)
  file(WRITE ${doc}/changelog.Debian "softgrain (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * Package of version ${CPACK_PACKAGE_VERSION}; changes are in changelog.gz.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
  file(RENAME ${doc}/CHANGELOG.md ${doc}/changelog)  # the name that Debian looks for
  execute_process(COMMAND gzip -9n -f ${doc}/changelog ${doc}/changelog.Debian ${root}/usr/share/man/man1/softgrain.1
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
