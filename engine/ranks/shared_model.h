/// @file shared_model.h  What a contact model tells of its last step, so that several processes can add it up to the
/// bits of one. Of a part, what this process counts.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/state/virial.h"
#include "engine/step/domain.h"

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
  /// Where the first half of the next step is done (ContactModel::is_ahead): the bodies in it, ghosts as their contacts
  /// of this process alone move them.
  virtual Extent begun() const { return {}; }
  /// From now on forces of steps that run on are told only where these bodies may need them; else what contacts read is
  /// in the states (BodyState::predicted). Returns whether that is so. only_spheres: as PartSetup has it.
  virtual bool tells_states(bool /*only_spheres*/) { return false; }
  /// The states have come with the bodies, in the middle of a step.
  virtual void take_states() {}
  /// Ghosts are where their owners have them in that step.
  virtual void take_ghosts(World&, std::span<const Slot>) {}
};

}  // namespace epafi
