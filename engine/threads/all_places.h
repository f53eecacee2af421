/// @file all_places.h  Where threads may run, for what is started from a thread that OpenMP has bound.
#pragma once

#if defined(__linux__)
#include <sched.h>
#endif

namespace epafi {

/// While it lives, the calling thread may run on all processors that OpenMP's threads are bound to (OMP_PROC_BIND,
/// GOMP_CPU_AFFINITY): programs and threads that it starts then are not bound to its own one. Nothing changes where
/// threads are not bound. (All threads of a program that was started from one processor stay there: hopper of 20 000,
/// two threads, 22 for 12 ns a sphere and step.)
class AllPlaces {
 public:
  AllPlaces();
  ~AllPlaces();
  AllPlaces(const AllPlaces&) = delete;
  AllPlaces& operator=(const AllPlaces&) = delete;

#if defined(__linux__)
 private:
  cpu_set_t before_;
  bool changed_ = false;
#endif
};

}  // namespace epafi
