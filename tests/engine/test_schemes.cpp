#include "engine/schemes/all_schemes.h"

#include <cmath>

#include "engine/step/step.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

struct NoPairs final : BroadPhase {
  const char* name() const override { return "none"; }
  void find_pairs(const World&, PairList&) override {}
};
struct NoContacts final : NarrowPhase {
  const char* name() const override { return "none"; }
  void collide(const World&, const PairList&, ContactSet&) override {}
};

/// A damped spring that ties every body to the origin: m a = -k x - c v, written as a force or as an impulse.
struct Spring final : ContactModel {
  double stiffness, damping;
  bool impulses;
  Spring(double k, double c, bool as_impulses) : stiffness(k), damping(c), impulses(as_impulses) {}
  const char* name() const override { return "spring"; }
  void act(World& world, ContactSet&, const StepClock& clock, StepReport&) override {
    for (Slot s = 0; s < world.size(); ++s) {
      if (impulses) {
        // the mean velocity of the step acts on the damper: (v + v')/2, solved for v'
        const double h = clock.dt * world.inverse_mass[s];
        const Vec3 push = -h * stiffness * world.position[s] + clock.dt * world.free_acceleration(s);
        world.velocity[s] = (world.velocity[s] * (1 - 0.5 * h * damping) + push) / (1 + 0.5 * h * damping);
        continue;
      }
      const Vec3 v = world.velocity[s] + clock.velocity_lag * clock.dt * world.acceleration(s);
      world.force[s] = -stiffness * world.position[s] - damping * v;
    }
  }
};

struct Run {
  World world{Columns{.rotation = false, .force = true}};
  Pipeline stage;
  Workspace work;
  double dt;

  Run(const SchemeEntry& scheme, double k, double c, double step_size) : dt(step_size) {
    stage.scheme = scheme.make();
    stage.broad_phase = std::make_unique<NoPairs>();
    stage.narrow_phase = std::make_unique<NoContacts>();
    stage.contact_model = std::make_unique<Spring>(k, c, !scheme.smooth);
  }
  void advance(int steps) {
    if (stage.scheme->needs_initial_forces() && world.time == 0.0) evaluate_forces(world, stage, work);
    for (int i = 0; i < steps; ++i) step(world, stage, work, dt);
  }
};

Body unit_body(double x, double v) {
  Body b;
  b.position.x() = x;
  b.velocity.x() = v;
  b.mass = 2.0;
  return b;
}

/// Error of x after a time of 3 with mass 2 and stiffness 8: omega = 2, with the damped solution where c > 0.
double oscillator_error(const SchemeEntry& scheme, double c, int steps) {
  Run run(scheme, 8.0, c, 3.0 / steps);
  run.world.add(unit_body(1.0, 0.5));
  run.advance(steps);
  const double g = c / 4.0, w = std::sqrt(4.0 - g * g);  // x = exp(-g t) (cos w t + (v0 + g x0)/w sin w t)
  const double exact = std::exp(-g * 3) * (std::cos(w * 3) + (0.5 + g) / w * std::sin(w * 3));
  return std::abs(run.world.position[0].x() - exact);
}

double order_of(const SchemeEntry& scheme, double c) {
  return std::log2(oscillator_error(scheme, c, 400) / oscillator_error(scheme, c, 800));
}

}  // namespace

TEST_CASE("schemes converge with their order on a harmonic oscillator", "[engine][schemes]") {
  for (const auto& s : all_schemes()) {
    INFO(s.entry.name);
    const double expected = s.entry.name == "symplectic-euler" ? 1.0 : 2.0;
    CHECK(order_of(s, 0.0) == Approx(expected).margin(0.05));
    CHECK(oscillator_error(s, 0.0, 800) < (expected > 1 ? 2e-5 : 1e-2));
  }
}

TEST_CASE("damping keeps the order: velocity Verlet sees the velocity at the end of its step", "[engine][schemes]") {
  for (const auto& s : all_schemes()) {
    INFO(s.entry.name);
    CHECK(order_of(s, 1.0) == Approx(s.entry.name == "symplectic-euler" ? 1.0 : 2.0).margin(0.1));
  }
}

TEST_CASE("energy of an undamped oscillator stays bounded for 1e5 periods' worth of steps", "[engine][schemes]") {
  for (const auto& s : all_schemes()) {
    INFO(s.entry.name);
    const double dt = 0.05;  // omega dt = 0.1
    Run run(s, 8.0, 0.0, dt);
    run.world.add(unit_body(1.0, 0.0));
    double least = 1e9, most = 0;
    for (int k = 0; k < 100000; ++k) {
      run.advance(1);
      const double x = run.world.position[0].x(), v = run.world.velocity[0].x(), energy = 4.0 * x * x + v * v;
      least = std::min(least, energy);
      most = std::max(most, energy);
    }
    // a modified energy is kept exactly: the energy swings by omega dt (first order) or (omega dt)^2/4 (second order)
    const double swing = s.entry.name == "symplectic-euler" ? 0.11 : 0.0026;
    CHECK(most / 4.0 < 1 + swing);
    CHECK(least / 4.0 > 1 - swing);
  }
}

TEST_CASE("free fall is exact to rounding for the second-order schemes, of order dt for symplectic Euler",
          "[engine][schemes]") {
  for (const auto& s : all_schemes()) {
    INFO(s.entry.name);
    Run run(s, 0.0, 0.0, 0.01);
    run.world.gravity = Vec3(0, 0, -9.81);
    run.world.add(unit_body(0, 1));
    run.advance(100);
    const double t = 1.0, exact = -0.5 * 9.81 * t * t;
    const double first_order = s.entry.name == "symplectic-euler" ? -0.5 * 9.81 * 0.01 : 0.0;  // -g dt t/2
    CHECK(run.world.position[0].z() == Approx(exact + first_order).epsilon(1e-13));
    CHECK(run.world.velocity[0].z() == Approx(-9.81).epsilon(1e-13));
    CHECK(run.world.position[0].x() == Approx(1.0).epsilon(1e-13));
    CHECK(run.world.time == Approx(1.0).epsilon(1e-13));
  }
}

TEST_CASE("driven bodies follow their velocity, whatever pushes them", "[engine][schemes]") {
  for (const auto& s : all_schemes()) {
    INFO(s.entry.name);
    Run run(s, 5.0, 1.0, 0.01);
    run.world.gravity = Vec3(0, 0, -9.81);
    Body wall = unit_body(0, 2);
    wall.mass = 0.0;
    run.world.add(wall);
    run.advance(50);
    CHECK(run.world.position[0].x() == Approx(1.0).epsilon(1e-13));
    CHECK(run.world.position[0].z() == 0.0);
    CHECK(run.world.velocity[0] == Vec3(2, 0, 0));
  }
}

TEST_CASE("stability ends at omega dt = 2 (case B02)", "[engine][schemes][B02]") {
  for (const auto& s : all_schemes()) {
    INFO(s.entry.name);
    for (double factor : {0.99, 1.01}) {
      Run run(s, 8.0, 0.0, factor);  // omega = 2: omega dt = 2 * factor
      run.world.add(unit_body(1.0, 0.0));
      run.advance(2000);
      CHECK((std::abs(run.world.position[0].x()) < 100) == (factor < 1));
    }
  }
}
