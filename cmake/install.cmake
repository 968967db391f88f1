# What `cmake --install` leaves: the program, the libraries with their headers, and what
# find_package(gear3k) reads.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

install(TARGETS gear3k DESTINATION ${CMAKE_INSTALL_BINDIR})
get_property(gear3k_libraries GLOBAL PROPERTY gear3k_libraries)
install(TARGETS ${gear3k_libraries} gear3k_flags gear3k_random123
        EXPORT gear3kTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/gear3k)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/gear3k
        FILES_MATCHING PATTERN *.hpp
        PATTERN cli EXCLUDE)
set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/gear3k)
install(EXPORT gear3kTargets NAMESPACE gear3k:: DESTINATION ${config_folder})
configure_package_config_file(
  ${PROJECT_SOURCE_DIR}/cmake/gear3kConfig.cmake.in ${PROJECT_BINARY_DIR}/gear3kConfig.cmake
  INSTALL_DESTINATION ${config_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/gear3kConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/gear3kConfig.cmake
              ${PROJECT_BINARY_DIR}/gear3kConfigVersion.cmake
        DESTINATION ${config_folder})
