/// @file halo.h  What a rank sees of bodies that others own: after each step their owners send what moves of them.
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
  /// Position, velocity, force and whatever else of the state changes in a step.
  void refresh(World& world) {
    begin(world);
    finish(world);
  }
  /// The same in two steps: own bodies stay as they are in between, ghosts must not be read.
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
