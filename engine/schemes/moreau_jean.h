/// @file moreau_jean.h  Moreau-Jean time stepping with theta = 1/2 (Moreau 1988; Jean 1999): drift half, velocities
/// jump by impulses at the middle configuration, drift half. Events are not located: order one where contacts open and
/// close.
#pragma once
#include "engine/step/pipeline.h"
#include "engine/threads/parallel.h"

namespace epafi {

class MoreauJean final : public Scheme {
 public:
  const char* name() const override { return "moreau-jean"; }
  void first_half(World& world, double dt) override { drift(world, 0.5 * dt); }
  void second_half(World& world, double dt) override { drift(world, 0.5 * dt); }

 private:
  static void drift(World& world, double dt) {
    parallel_for(world.size(), [&](std::size_t i) {
      const auto s = static_cast<Slot>(i);
      world.position[s] += dt * world.velocity[s];
      if (world.rotates()) world.rotate(s, dt);
    });
  }
};

}  // namespace epafi
