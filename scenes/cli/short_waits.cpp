#include "scenes/cli/short_waits.h"

#include <cstdlib>

#if defined(__linux__)
#include <unistd.h>
#endif

namespace epafi {

void wait_briefly([[maybe_unused]] char** argv) {
#if defined(__linux__)
  if (std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr) return;
  // Half a millisecond. Two threads on two processors, one of them shared with another program: a bed of 10 000 takes 65
  // ns a sphere and step for 760 with libgomp's 300 000 turns; with 200 turns 40, but 31 for 24 alone.
  if (setenv("GOMP_SPINCOUNT", "10000", 1) == 0) execv("/proc/self/exe", argv);
#endif
}

}  // namespace epafi
