/// @file processor_time.h  What this process has used of the processors, whatever else runs beside it.
#pragma once
#include <time.h>

namespace epafi {

/// Of all threads of this process since it began [s].
inline double process_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace epafi
