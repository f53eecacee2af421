# Installation in parts. program: the program, scenes, schema, manual, completion. development: static libraries,
# headers under include/epafi, examples, the CMake package. python (option EPAFI_PYTHON): the module.
# `cpack --config build/CPackConfig.cmake` makes a Debian package of each.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/epafi)
set(data_dir ${CMAKE_INSTALL_DATADIR}/epafi)
install(TARGETS epafi_engine epafi_detection epafi_laws epafi_viz_export epafi_scenes epafi_facade EXPORT epafi-targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
foreach(floor engine detection laws viz_export scenes)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${floor} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/epafi COMPONENT development
    FILES_MATCHING PATTERN "*.h" PATTERN "library" EXCLUDE PATTERN "include" EXCLUDE PATTERN "python" EXCLUDE)
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/scenes/include/epafi/epafi.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/epafi
  COMPONENT development)
install(EXPORT epafi-targets NAMESPACE epafi:: DESTINATION ${package_dir} COMPONENT development)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/epafi-config.cmake.in ${PROJECT_BINARY_DIR}/epafi-config.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/epafi-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/epafi-config.cmake ${PROJECT_BINARY_DIR}/epafi-config-version.cmake
  DESTINATION ${package_dir} COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/epafi-dev/examples
  COMPONENT development)

install(TARGETS epafi RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
if(EPAFI_MPI)
  install(TARGETS epafi-mpi RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes/library/ DESTINATION ${data_dir}/scenes COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/scenes/scene.schema.json DESTINATION ${data_dir} COMPONENT program)
# MIT, with LGPL-3 parts in binaries
install(FILES ${PROJECT_SOURCE_DIR}/cmake/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/epafi COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/epafi-dev
  COMPONENT development)
if(EPAFI_PYTHON)
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-epafi
    COMPONENT python)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/CITATION.cff
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/epafi COMPONENT program)
# the program writes its own manual and completion
install(CODE "set(root \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
  file(MAKE_DIRECTORY \${root}/man/man1 \${root}/bash-completion/completions)
  execute_process(COMMAND $<TARGET_FILE:epafi> man OUTPUT_FILE \${root}/man/man1/epafi.1 COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND $<TARGET_FILE:epafi> completion OUTPUT_FILE \${root}/bash-completion/completions/epafi
    COMMAND_ERROR_IS_FATAL ANY)"
  COMPONENT program)

if(PROJECT_IS_TOP_LEVEL)
  set(CPACK_GENERATOR DEB)
  set(CPACK_PACKAGE_NAME epafi)
  set(CPACK_PACKAGE_CONTACT "The Epafi developers <epafi@localhost>")
  set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
  set(CPACK_STRIP_FILES ON)
  set(CPACK_COMPONENTS_ALL program development)
  set(CPACK_DEB_COMPONENT_INSTALL ON)
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_DEBIAN_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME epafi)
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS gnuplot-nox)
  set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
    "many-body contact engine\n Smooth contact laws and non-smooth solvers on one scene file; wheel-rail contact.")
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME epafi-dev)
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libeigen3-dev, libfmt-dev, libhdf5-dev, libtomlplusplus-dev, zlib1g-dev, libgmp-dev, libmpfr-dev")
  set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
    "many-body contact engine, library\n Static libraries, headers, examples and CMake package of Epafi.")
  if(EPAFI_PYTHON)
    list(APPEND CPACK_COMPONENTS_ALL python)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-epafi)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy")
    set(CPACK_COMPONENT_PYTHON_DESCRIPTION
      "many-body contact engine, Python module\n Runs scenes of Epafi from Python; states as NumPy arrays.")
  endif()
  include(CPack)
endif()
