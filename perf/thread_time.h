/// @file thread_time.h  Processor time of the calling thread, whatever else runs beside it.
#pragma once
#include <time.h>

namespace epafi {

/// Since the thread began [s].
inline double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace epafi
