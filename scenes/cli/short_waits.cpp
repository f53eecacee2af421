#include "scenes/cli/short_waits.h"

#include <cstdlib>

#include "engine/all_places.h"

#if defined(__linux__)
#include <unistd.h>
#endif

namespace epafi {

void wait_briefly([[maybe_unused]] char** argv) {
#if defined(__linux__)
  if (std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr) return;
  // Half a millisecond. Two threads on two processors beside two other programs: a bed of 10 000 takes 65 to 79 ns a
  // sphere and step, with libgomp's 300 000 turns 81 to 822. Alone it takes 24 with both, with 200 turns 31.
  const AllPlaces places;  // libgomp has bound this thread before main
  if (setenv("GOMP_SPINCOUNT", "10000", 1) == 0) execv("/proc/self/exe", argv);
#endif
}

}  // namespace epafi
