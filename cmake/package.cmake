# Installation: static libraries, headers under include/epafi, the program, the scene library, the CMake package.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/epafi)
install(TARGETS epafi_engine epafi_detection epafi_laws epafi_viz_export epafi_scenes epafi_facade EXPORT epafi-targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS epafi RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
foreach(floor engine detection laws viz_export scenes)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${floor} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/epafi FILES_MATCHING PATTERN "*.h"
    PATTERN "library" EXCLUDE PATTERN "include" EXCLUDE)
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/scenes/include/epafi/epafi.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/epafi)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes/library/ DESTINATION ${CMAKE_INSTALL_DATADIR}/epafi/scenes)
install(EXPORT epafi-targets NAMESPACE epafi:: DESTINATION ${package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/epafi-config.cmake.in ${PROJECT_BINARY_DIR}/epafi-config.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/epafi-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/epafi-config.cmake ${PROJECT_BINARY_DIR}/epafi-config-version.cmake DESTINATION ${package_dir})
