# cmake --install: the library, static and shared, with its public headers, the command line tool, and a package for
# find_package(sansmesh).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(SANSMESH_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/sansmesh)

set(SANSMESH_LIBRARIES sansmesh)
if(TARGET sansmesh_shared)
  list(APPEND SANSMESH_LIBRARIES sansmesh_shared)
endif()
install(TARGETS ${SANSMESH_LIBRARIES} EXPORT sansmeshTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
get_property(headers GLOBAL PROPERTY SANSMESH_HEADERS)
install(FILES ${headers} ${PROJECT_BINARY_DIR}/include/sansmesh/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sansmesh)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/THIRD_PARTY.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
# The prefix is known when it is installed.
install(CODE "
  set(CMAKE_INSTALL_LIBDIR \"${CMAKE_INSTALL_LIBDIR}\")
  set(CMAKE_INSTALL_INCLUDEDIR \"${CMAKE_INSTALL_INCLUDEDIR}\")
  set(PROJECT_DESCRIPTION \"${PROJECT_DESCRIPTION}\")
  set(PROJECT_VERSION \"${PROJECT_VERSION}\")
  configure_file(\"${PROJECT_SOURCE_DIR}/cmake/sansmesh.pc.in\" \"${PROJECT_BINARY_DIR}/sansmesh.pc\" @ONLY)
  file(INSTALL DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/pkgconfig\" TYPE FILE FILES \"${PROJECT_BINARY_DIR}/sansmesh.pc\")")
install(EXPORT sansmeshTargets NAMESPACE sansmesh:: DESTINATION ${SANSMESH_PACKAGE_DIR})

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/sansmeshConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/sansmeshConfig.cmake INSTALL_DESTINATION ${SANSMESH_PACKAGE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sansmeshConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sansmeshConfig.cmake ${PROJECT_BINARY_DIR}/sansmeshConfigVersion.cmake
        DESTINATION ${SANSMESH_PACKAGE_DIR})

if(TARGET sansmesh_cli)
  install(TARGETS sansmesh_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  # The tool writes its manual pages and completions itself, when it is installed; one for another machine cannot run here.
  if(NOT CMAKE_CROSSCOMPILING)
    install(CODE "
      set(texts \"${PROJECT_BINARY_DIR}/texts\")
      set(share \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
      file(REMOVE_RECURSE \"\${texts}\")
      file(MAKE_DIRECTORY \"\${texts}/man1\")
      execute_process(COMMAND \"$<TARGET_FILE:sansmesh_cli>\" manual --folder \"\${texts}/man1\" COMMAND_ERROR_IS_FATAL ANY)
      file(GLOB pages \"\${texts}/man1/*.1\")
      file(INSTALL DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1\" TYPE FILE FILES \${pages})
      foreach(shell_place bash:bash-completion/completions/sansmesh zsh:zsh/site-functions/_sansmesh
                          fish:fish/vendor_completions.d/sansmesh.fish)
        string(REPLACE : \";\" shell_place \${shell_place})
        list(GET shell_place 0 shell)
        list(GET shell_place 1 place)
        get_filename_component(folder \${place} DIRECTORY)
        get_filename_component(name \${place} NAME)
        execute_process(COMMAND \"$<TARGET_FILE:sansmesh_cli>\" completion \${shell} OUTPUT_FILE \"\${texts}/\${name}\"
                        COMMAND_ERROR_IS_FATAL ANY)
        file(INSTALL DESTINATION \"\${share}/\${folder}\" TYPE FILE FILES \"\${texts}/\${name}\")
      endforeach()")
  endif()
endif()
