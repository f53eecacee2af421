/// @file run_on_scheme.h  Optional interface of a scheme beside its halves.
#pragma once
#include "engine/state/world.h"

namespace epafi {

class RunOnScheme {
 public:
  virtual ~RunOnScheme() = default;
  /// The second half of a step and the first half of the next, with the same dt, in one pass over slots [begin, end);
  /// bodies must not be read in between.
  virtual void run_on(World& world, double dt, std::size_t begin, std::size_t end) = 0;
};

}  // namespace epafi
