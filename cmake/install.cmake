# What `cmake --install` leaves.  Component `program`: the program with its manual, completion,
# examples and documents, which is the Debian package too (package.cmake).  Component `library`: the
# libraries with their headers, and what find_package(gear3k) reads.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

install(TARGETS gear3k DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
# Manual and completion are printed by the program that is installed.
set(gear3k_made ${PROJECT_BINARY_DIR}/made)
install(CODE "set(gear3k_made \"${gear3k_made}\")" COMPONENT program)
install(CODE "set(gear3k_program \"$<TARGET_FILE:gear3k>\")" COMPONENT program)
install(SCRIPT ${PROJECT_SOURCE_DIR}/cmake/made_by_program.cmake COMPONENT program)
install(DIRECTORY ${gear3k_made}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
install(FILES ${gear3k_made}/completion DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME gear3k COMPONENT program)
# Documents find each other, examples and data as in the sources.
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs ${PROJECT_SOURCE_DIR}/examples ${PROJECT_SOURCE_DIR}/data
        DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)

get_property(gear3k_libraries GLOBAL PROPERTY gear3k_libraries)
install(TARGETS ${gear3k_libraries} gear3k_flags gear3k_random123
        EXPORT gear3kTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/gear3k COMPONENT library)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/gear3k COMPONENT library
        FILES_MATCHING PATTERN *.hpp
        PATTERN cli EXCLUDE)
set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/gear3k)
install(EXPORT gear3kTargets NAMESPACE gear3k:: DESTINATION ${config_folder} COMPONENT library)
configure_package_config_file(
  ${PROJECT_SOURCE_DIR}/cmake/gear3kConfig.cmake.in ${PROJECT_BINARY_DIR}/gear3kConfig.cmake
  INSTALL_DESTINATION ${config_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/gear3kConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/gear3kConfig.cmake
              ${PROJECT_BINARY_DIR}/gear3kConfigVersion.cmake
        DESTINATION ${config_folder} COMPONENT library)
