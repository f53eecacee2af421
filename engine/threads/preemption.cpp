#include "engine/threads/preemption.h"

#include <algorithm>

#if defined(__linux__)
#include <sys/resource.h>
#endif

namespace epafi {

long involuntary_switches() {
#if defined(RUSAGE_THREAD)
  rusage usage{};
  return getrusage(RUSAGE_THREAD, &usage) == 0 ? usage.ru_nivcsw : 0;
#else
  return 0;
#endif
}

void Preemptions::count(double now, double lost) {
  constexpr double allowed = 0.2;       // of the time
  constexpr double burst = 0.01;        // lost at once [s]
  constexpr double longest_rest = 2.0;  // [s]
  level_ = std::max(0.0, level_ - allowed * (now - last_)) + lost;
  last_ = now;
  if (level_ <= burst) return;
  rest_ = now - end_of_rest_ < 4 * rest_ ? std::min(2 * rest_, longest_rest) : shortest_rest;
  end_of_rest_ = now + rest_;
  level_ = 0.0;
}

}  // namespace epafi
