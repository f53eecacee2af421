# Fails when an include breaks the floors, a dependency has two doors, or a file is too long.
# Run as: cmake -DROOT=<source folder> -P cmake/check_floors.cmake
cmake_minimum_required(VERSION 3.22)
set(problems "")
function(complain text)
  set(problems "${problems}\n  ${text}" PARENT_SCOPE)
endfunction()

# who may include whom: a floor names the floors below it
set(below_engine engine)
set(below_detection engine detection)
set(below_laws engine laws)
set(below_ranks engine ranks)
set(below_viz_export engine detection laws viz_export)
set(below_scenes engine detection laws ranks viz_export scenes)

# one door per dependency: header pattern -> the only files that may include it
set(doors
  "omp\\.h|engine/threads/parallel\\.h"
  "hdf5\\.h|viz_export/hdf5/hdf5_file\\.cpp,viz_export/hdf5/hdf5_driver\\.cpp"
  "CGAL/|detection/shapes/exact_hull\\.cpp,tests/detection/test_exact_oracle\\.cpp"
  "toml\\+\\+/|scenes/reader/toml_text\\.cpp"
  "CLI/|scenes/cli/usage\\.h"
  "mpi\\.h|ranks/communicator\\.cpp,ranks/mpi_messages\\.cpp,ranks/plan\\.cpp,ranks/shared_rows\\.cpp"
  "zoltan|ranks/communicator\\.cpp,ranks/partition\\.cpp"
  "zlib\\.h|viz_export/hdf5/deflate\\.cpp"
  "nlohmann/|viz_export/files/json_reader\\.cpp"
  "catch2/|tests/support/catch\\.h")

foreach(floor engine detection laws ranks viz_export scenes)
  file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/${floor}/*.h ${ROOT}/${floor}/*.cpp)
  foreach(file ${files})
    file(STRINGS ${ROOT}/${file} includes REGEX "^#include \"")
    foreach(line ${includes})
      string(REGEX MATCH "\"([a-z_]+)/" found "${line}")
      set(target "${CMAKE_MATCH_1}")
      if(target MATCHES "^(engine|detection|laws|ranks|viz_export|scenes|tests|perf)$"
         AND NOT target IN_LIST below_${floor})
        complain("${file}: ${floor} must not include ${target}: ${line}")
      endif()
    endforeach()
    file(STRINGS ${ROOT}/${file} pragmas REGEX "^ *#pragma omp")
    foreach(line ${pragmas})
      if(NOT file STREQUAL "engine/threads/parallel.h" AND NOT line MATCHES "omp simd")
        complain("${file}: OpenMP lives in engine/threads/parallel.h: ${line}")
      endif()
    endforeach()
  endforeach()
endforeach()

file(GLOB_RECURSE all RELATIVE ${ROOT} ${ROOT}/engine/* ${ROOT}/detection/* ${ROOT}/laws/* ${ROOT}/ranks/*
     ${ROOT}/viz_export/* ${ROOT}/scenes/* ${ROOT}/tests/* ${ROOT}/perf/*)
list(FILTER all INCLUDE REGEX "\\.(h|cpp|py|cmake)$")
foreach(file ${all})
  file(STRINGS ${ROOT}/${file} lines)
  file(READ ${ROOT}/${file} text)
  string(REGEX MATCHALL "\n" newlines "${text}")
  list(LENGTH newlines count)
  if(count GREATER 500)
    complain("${file}: ${count} lines, at most 500")
  endif()
  foreach(door ${doors})
    string(REGEX REPLACE "\\|.*" "" header "${door}")
    string(REGEX REPLACE "^[^|]*\\|" "" allowed "${door}")
    string(REPLACE "," ")$|^(" allowed "${allowed}")
    file(STRINGS ${ROOT}/${file} hits REGEX "^#include [<\"]${header}")
    if(hits AND NOT file MATCHES "^(${allowed})$")
      complain("${file}: second door to a dependency: ${hits}")
    endif()
  endforeach()
endforeach()

if(problems)
  message(FATAL_ERROR "floors:${problems}")
endif()
message(STATUS "floors, doors and file lengths hold")
