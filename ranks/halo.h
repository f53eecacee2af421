/// @file halo.h  Ghosts of a rank: after each step the owners send the changed state of bodies.
#pragma once
#include <span>
#include <utility>
#include <vector>

#include "engine/state/world.h"
#include "ranks/plan.h"

namespace epafi {

class Halo {
 public:
  /// sends: ranks and slots; place: by slot, ascending, in the order of all bodies. By all ranks, as refresh.
  void set_up(const World& world, std::vector<std::pair<int, Slot>> sends, const std::vector<std::uint32_t>& place);
  /// Updates position, velocity, force and other state that changes in a step.
  void refresh(World& world) {
    begin(world);
    finish(world);
  }
  /// The same in two parts: in between, own bodies must not change and ghosts must not be read.
  void begin(World& world);
  void finish(World& world);
  std::span<const Slot> ghosts() const { return into_; }
  double bytes() const { return bytes_; }  ///< sent by this rank in all steps

 private:
  Plan plan_;
  std::vector<Slot> from_, into_;
  RowBytes out_, in_;
  double bytes_ = 0.0;
};

}  // namespace epafi
