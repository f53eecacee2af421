#include "engine/threads/preemption.h"

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

}  // namespace epafi
