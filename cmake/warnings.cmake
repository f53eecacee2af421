# One interface target with all warnings and the flags that decide bits: no contraction, no fast-math, no -march=native.
# -Wno-restrict: GCC 12 reports std::string + char* wrongly (its bug 105651).
add_library(epafi_warnings INTERFACE)
target_compile_options(epafi_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-psabi -Wno-restrict -ffp-contract=off)
if(EPAFI_WERROR)
  target_compile_options(epafi_warnings INTERFACE -Werror)
endif()
if(CMAKE_BUILD_TYPE STREQUAL "Debug")
  target_compile_definitions(epafi_warnings INTERFACE EPAFI_CHECK_CONTRACTS)
endif()
