/// @file moreau_jean.h  Moreau-Jean time stepping with theta = 1/2 (Moreau 1988; Jean 1999): drift half, velocities jump by
/// impulses at the middle configuration, drift half. Events are not located: order one where contacts open and close.
#pragma once
#include "engine/parallel.h"
#include "engine/pipeline.h"
#include "engine/rotation.h"

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
      if (!world.rotates()) return;
      if (world.is_movable(s)) rotate_freely(world.orientation[s], world.angular_velocity[s], world.inverse_inertia[s], dt);
      else world.orientation[s] = turned(world.orientation[s], dt * world.angular_velocity[s]);
    });
  }
};

}  // namespace epafi
