/// @file run_on_scheme.h  What a scheme may offer beside its halves.
#pragma once
#include "engine/state/world.h"

namespace epafi {

class RunOnScheme {
 public:
  virtual ~RunOnScheme() = default;
  /// The second half of a step and the first one of the next, of the same dt, at once for the bodies of slots
  /// [begin, end): nobody reads them in between.
  virtual void run_on(World& world, double dt, std::size_t begin, std::size_t end) = 0;
};

}  // namespace epafi
