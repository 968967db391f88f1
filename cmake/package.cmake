# `cpack -G DEB` in the build folder makes the package gear3k for Debian: the component `program` of
# install.cmake and what Debian wants beside it.  Its Depends are those that dpkg-shlibdeps computes;
# without gnuplot figures are missing, and every command says so.  DEBFULLNAME and DEBEMAIL say who
# makes it.  With SOURCE_DATE_EPOCH the same build gives the same bytes.
set(contact "gear3k contributors <gear3k@example.org>")
if(DEFINED ENV{DEBEMAIL})
  set(contact "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
endif()
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME gear3k)
set(CPACK_PACKAGE_VENDOR "gear3k contributors")
set(CPACK_PACKAGE_CONTACT "${contact}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "design optimiser for 3K compound planetary gearboxes")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "From a ratio, a size, a limit on lost motion and a coefficient of friction
gear3k tries every tooth count of a Wolfrom gear for a robot actuator,
refines profile shifts, modules and centre distance for efficiency in either
drive direction, and returns the best gearbox with the margin of every check
and its drawings. It runs a gearbox at any speed, load and temperature, tells
what gearboxes built within their tolerances will do, and sets measurements of
a real one beside the simulation.")

set(debian_files ${PROJECT_BINARY_DIR}/debian_files)
foreach(name IN ITEMS PROJECT_SOURCE_DIR PROJECT_VERSION CPACK_PACKAGE_CONTACT debian_files)
  install(CODE "set(${name} \"${${name}}\")" COMPONENT debian EXCLUDE_FROM_ALL)
endforeach()
install(SCRIPT ${PROJECT_SOURCE_DIR}/cmake/debian_files.cmake COMPONENT debian EXCLUDE_FROM_ALL)
install(DIRECTORY ${debian_files}/ DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT debian EXCLUDE_FROM_ALL)
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};gear3k;program;/"
                                 "${PROJECT_BINARY_DIR};gear3k;debian;/")
include(CPack)
