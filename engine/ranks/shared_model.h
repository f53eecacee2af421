/// @file shared_model.h  What a contact model tells of its last step, so that several processes can add it up to the
/// bits of one. Of a part, what this process counts.
#pragma once
#include <cstdint>
#include <vector>

#include "engine/state/virial.h"

namespace epafi {

/// Of a spring on a fixed or driven body, as processes send it to each other.
struct HeldPull {
  std::uint64_t order = 0;  ///< among all springs
  BodyId body{};
  double force[3] = {}, torque[3] = {};  ///< taken off those of the body [N], [N m]
};

class SharedModel {
 public:
  virtual ~SharedModel() = default;
  /// Of the contacts that it has found itself, in a periodic cell.
  virtual void add_virial(const World&, Virial&) const {}
  /// What it has put on fixed and driven bodies beside contacts, in the order in which it does.
  virtual void append_held_pulls(const World&, std::vector<HeldPull>&) const {}
};

}  // namespace epafi
