#include "engine/threads/all_places.h"

#include "engine/threads/parallel.h"

namespace epafi {

#if defined(__linux__)
AllPlaces::AllPlaces() {
  const std::vector<int> bound = bound_processors();
  if (bound.empty() || sched_getaffinity(0, sizeof before_, &before_) != 0) return;
  cpu_set_t all = before_;
  for (const int id : bound)
    if (id < CPU_SETSIZE) CPU_SET(static_cast<std::size_t>(id), &all);
  changed_ = sched_setaffinity(0, sizeof all, &all) == 0;
}

AllPlaces::~AllPlaces() {
  if (changed_) sched_setaffinity(0, sizeof before_, &before_);
}
#else
AllPlaces::AllPlaces() = default;
AllPlaces::~AllPlaces() = default;
#endif

}  // namespace epafi
