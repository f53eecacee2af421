/// @file shared_model.h  Data of a contact model's last step that several processes sum to the bits of one process;
/// each counts its part.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/state/virial.h"
#include "engine/step/domain.h"

namespace epafi {

/// Load of a spring on a fixed or driven body, as sent between processes.
struct HeldPull {
  std::uint64_t order = 0;  ///< among all springs
  BodyId body{};
  double force[3] = {}, torque[3] = {};  ///< taken off those of the body [N], [N m]
};

class SharedModel {
 public:
  virtual ~SharedModel() = default;
  /// Adds the virial of the contacts that the model has found itself, in a periodic cell.
  virtual void add_virial(const World&, Virial&) const {}
  /// Appends its loads on fixed and driven bodies other than by contacts, in the order of application.
  virtual void append_held_pulls(const World&, std::vector<HeldPull>&) const {}
  /// Where the first half of the next step is done (ContactModel::is_ahead): extent of the bodies in it, with ghosts
  /// moved by the contacts of this process only.
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
