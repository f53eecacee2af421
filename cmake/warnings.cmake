# One interface target with all warnings and the flags that decide bits: no contraction, no fast-math, no -march=native.
# Off, because GCC 12 reports them wrongly for std::string (its bug 105651): restrict, stringop-overflow, array-bounds.
# In a unit of several files a local name may equal a name of a neighbour's anonymous namespace: no mistake.
set(shadow -Wshadow)
if(EPAFI_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(shadow -Wshadow=local)
elseif(EPAFI_UNITY)
  set(shadow "")  # Clang knows no =local
endif()
add_library(epafi_warnings INTERFACE)
set(gcc_bugs -Wno-restrict -Wno-stringop-overflow -Wno-array-bounds)
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Clang counts the first to -Wconversion, GCC does not; the second tells of simd loops that sanitizers keep scalar
  set(gcc_bugs -Wno-sign-conversion -Wno-pass-failed)
endif()
target_compile_options(epafi_warnings INTERFACE -Wall -Wextra -Wpedantic ${shadow} -Wconversion -Wno-psabi ${gcc_bugs}
  -ffp-contract=off)
if(EPAFI_WERROR)
  target_compile_options(epafi_warnings INTERFACE -Werror)
endif()
if(CMAKE_BUILD_TYPE STREQUAL "Debug")
  target_compile_definitions(epafi_warnings INTERFACE EPAFI_CHECK_CONTRACTS)
endif()
