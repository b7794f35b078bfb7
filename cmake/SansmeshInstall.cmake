# cmake --install: the library with its headers under their include paths, the command line tool, and a package for
# find_package(sansmesh).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(SANSMESH_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/sansmesh)

install(TARGETS sansmesh EXPORT sansmeshTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/sansmesh DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.h" PATTERN "*-inl.h" EXCLUDE)
install(EXPORT sansmeshTargets NAMESPACE sansmesh:: DESTINATION ${SANSMESH_PACKAGE_DIR})

if(NOT DEFINED BUILD_SHARED_LIBS)
  set(BUILD_SHARED_LIBS OFF)
endif()
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/sansmeshConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/sansmeshConfig.cmake INSTALL_DESTINATION ${SANSMESH_PACKAGE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sansmeshConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sansmeshConfig.cmake ${PROJECT_BINARY_DIR}/sansmeshConfigVersion.cmake
        DESTINATION ${SANSMESH_PACKAGE_DIR})

if(TARGET sansmesh_cli)
  install(TARGETS sansmesh_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
