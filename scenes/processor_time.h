/// @file processor_time.h  Processor time, whatever else runs beside it.
#pragma once
#include <time.h>

namespace epafi {

inline double seconds_of(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Processor time of all threads of this process since its start [s].
inline double process_seconds() { return seconds_of(CLOCK_PROCESS_CPUTIME_ID); }
/// Processor time of the calling thread since its start [s].
inline double thread_seconds() { return seconds_of(CLOCK_THREAD_CPUTIME_ID); }

}  // namespace epafi
