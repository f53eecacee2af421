/// @file symplectic_euler.h  Kick, then drift: first order, the cheapest for smooth contact; bounded below dt =
/// 2/omega.
#pragma once
#include "engine/step/pipeline.h"
#include "engine/threads/parallel.h"

namespace epafi {

class SymplecticEuler final : public Scheme {
 public:
  const char* name() const override { return "symplectic-euler"; }
  /// Not for the forces, but for the energy in contacts that are closed at the start.
  bool needs_initial_forces() const override { return true; }
  void first_half(World&, double) override {}
  void second_half(World& world, double dt) override {
    parallel_for(world.size(), [&](std::size_t i) {
      const auto s = static_cast<Slot>(i);
      if (world.is_movable(s)) world.velocity[s] += dt * world.acceleration(s);
      world.position[s] += dt * world.velocity[s];
      if (!world.rotates()) return;
      if (world.is_movable(s)) world.apply_angular_impulse(s, dt * world.torque[s]);
      world.rotate(s, dt);
    });
  }
};

}  // namespace epafi
