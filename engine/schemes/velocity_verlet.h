/// @file velocity_verlet.h  Kick, drift, kick (Verlet 1967; Swope et al. 1982): second order, for smooth contact.
/// Between the halves world.velocity is that of the middle of the step; contact laws see velocities at its end
/// through StepClock::velocity_lag, so damping is of second order too. Bounded below dt = 2/omega (case B02).
#pragma once
#include "engine/schemes/run_on_scheme.h"
#include "engine/state/spin_bodies.h"
#include "engine/step/pipeline.h"
#include "engine/threads/parallel.h"

namespace epafi {

class VelocityVerlet final : public Scheme, public RunOnScheme {
 public:
  const char* name() const override { return "velocity-verlet"; }
  double velocity_lag() const override { return 0.5; }
  bool needs_initial_forces() const override { return true; }

  bool has_ranges() const override { return true; }

  void first_half(World& world, double dt) override {
    parallel_blocks(world.size(), range,
                    [&](std::size_t i, std::size_t end, std::size_t) { first_half(world, dt, i, end); });
  }
  void second_half(World& world, double dt) override {
    parallel_blocks(world.size(), range,
                    [&](std::size_t i, std::size_t end, std::size_t) { second_half(world, dt, i, end); });
  }
  void first_half(World& world, double dt, std::size_t begin, std::size_t end) override {
    kick_and_drift(world, dt, 1, true, begin, end);
  }
  void second_half(World& world, double dt, std::size_t begin, std::size_t end) override {
    kick_and_drift(world, dt, 1, false, begin, end);
  }
  void run_on(World& world, double dt, std::size_t begin, std::size_t end) override {
    kick_and_drift(world, dt, 2, true, begin, end);
  }

 private:
  static constexpr std::size_t range = 512;
  /// Makes `kicks` half kicks by the forces of the world, and the drift if `drifts`.
  static void kick_and_drift(World& world, double dt, int kicks, bool drifts, std::size_t begin, std::size_t end) {
    const bool turns = world.has_orientation(), uneven = turns && has_uneven(world);
    for (std::size_t i = begin; i < end; ++i) {
      const auto s = static_cast<Slot>(i);
      const bool spins = uneven && !world.is_isotropic(s);
      for (int k = 0; k < kicks; ++k)
        if (spins)
          push(world, s, 0.5 * dt);
        else
          kick(world, s, 0.5 * dt);
      if (!drifts) continue;
      for (int k = 0; k < 3; ++k) world.position[s][k] += dt * world.velocity[s][k];
      if (turns && !spins) world.rotate(s, dt);
    }
    if (uneven) spin_bodies(world, 0.5 * dt, kicks, drifts ? dt : 0.0, begin, end);
  }
  static bool has_uneven(const World& world) { return world.columns().anisotropy && world.columns().free_turn; }
  /// World::acceleration and apply_angular_impulse with their common cases in place: three quarters of the time.
  [[gnu::always_inline]] static inline void kick(World& world, Slot s, double dt) {
    if (!(world.inverse_mass[s] > 0.0)) return;
    push(world, s, dt);
    if (!world.rotates()) return;
    const Vec3& torque = world.torque[s];
    if (world.columns().anisotropy) return world.apply_angular_impulse(s, dt * torque);
    const double inverse = world.inverse_moment[s];
    Vec3& w = world.angular_velocity[s];
    for (int k = 0; k < 3; ++k) w[k] += inverse * (dt * torque[k]);
  }
  /// The linear part of a kick.
  [[gnu::always_inline]] static inline void push(World& world, Slot s, double dt) {
    const Vec3 free = world.columns().external_force ? world.free_acceleration(s) : world.gravity;
    const double inverse_mass = world.inverse_mass[s];
    const Vec3& force = world.force[s];
    Vec3& v = world.velocity[s];
    for (int k = 0; k < 3; ++k) v[k] += dt * (free[k] + inverse_mass * force[k]);
  }
};

}  // namespace epafi
