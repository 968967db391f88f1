# Within cpack: fills ${debian_files} with the package's licence and its two changelogs; dates are
# those of CHANGELOG.md.  Folders that were made on the way get what Debian wants, whatever umask is;
# outside cpack those of the prefix are others' as well and stay as they are.
set(root $ENV{DESTDIR}${CMAKE_INSTALL_PREFIX})
if(root MATCHES "/_CPack_Packages/")
  file(CHMOD_RECURSE ${root} DIRECTORY_PERMISSIONS
       OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
endif()
string(REPLACE . \\. version ${PROJECT_VERSION})
file(STRINGS ${PROJECT_SOURCE_DIR}/CHANGELOG.md heading REGEX "^## ${version} \\(.*\\)$")
if(NOT heading MATCHES "([0-9]+-[0-9]+-[0-9]+)\\)$")
  message(FATAL_ERROR "CHANGELOG.md: no heading \"## ${PROJECT_VERSION} (date)\"")
endif()
execute_process(COMMAND date --utc --rfc-email --date=${CMAKE_MATCH_1} OUTPUT_VARIABLE date
                OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
file(REMOVE_RECURSE ${debian_files})
file(WRITE ${debian_files}/changelog.Debian
     "gear3k (${PROJECT_VERSION}-1) unstable; urgency=medium\n\n"
     "  * gear3k ${PROJECT_VERSION}: see changelog.gz.\n\n"
     " -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
configure_file(${PROJECT_SOURCE_DIR}/CHANGELOG.md ${debian_files}/changelog COPYONLY)
execute_process(COMMAND gzip -9n ${debian_files}/changelog.Debian ${debian_files}/changelog
                COMMAND_ERROR_IS_FATAL ANY)
# The licence as a paragraph of a copyright file: indented, and "." on an empty line.
file(READ ${PROJECT_SOURCE_DIR}/LICENSE licence)
string(REGEX REPLACE "^.*Copyright \\(c\\) ([^\n]*)\n.*$" "\\1" copyright "${licence}")
string(REGEX REPLACE "^.*Copyright[^\n]*\n+" "" text "${licence}")
string(REGEX REPLACE "\n+$" "" text "${text}")
string(REGEX REPLACE "\n" "\n " text "${text}")
string(REGEX REPLACE "\n \n" "\n .\n" text "${text}")
file(WRITE ${debian_files}/copyright
     "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n"
     "Upstream-Name: gear3k\n\nFiles: *\nCopyright: ${copyright}\nLicense: Expat\n ${text}\n")
