# One folder = one floor = one target. epafi_floor(name sources...) makes the static library epafi_<name>, alias
# epafi::<name>.
function(epafi_floor name)
  add_library(epafi_${name} STATIC ${ARGN})
  add_library(epafi::${name} ALIAS epafi_${name})
  set_target_properties(epafi_${name} PROPERTIES EXPORT_NAME ${name})
  epafi_compiles_as_floor(epafi_${name})
  if(name STREQUAL "engine")
    target_precompile_headers(epafi_engine PRIVATE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/engine/precompiled.h>)
  else()
    target_precompile_headers(epafi_${name} REUSE_FROM epafi_engine)
  endif()
endfunction()

# What every target of a floor is compiled with, but for the precompiled header: GCC 12 gives a file that takes it the
# optimisation of the header, and does not say that options of the file differ (Eigen's headers push and pop them).
function(epafi_compiles_as_floor target)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/epafi>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:epafi_warnings>)
endfunction()
