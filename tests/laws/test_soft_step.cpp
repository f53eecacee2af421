// Soft constraints with substeps: what the spring leaves, what stays exact, what the residual tells.
#include "engine/threads/parallel.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/support/rigid_experiment.h"

using namespace epafi;
using namespace epafi::test;

namespace {
RigidSettings soft(double dt, double frequency = 30.0, double restitution = 0.0) {
  RigidSettings s{.friction = 0.5, .restitution = restitution, .dt = dt, .solver = "soft-step"};
  s.parameters.set("frequency", frequency);
  return s;
}

/// n unit cubes on a plane.
RigidExperiment tower(int n, const RigidSettings& settings) {
  RigidExperiment x(settings);
  x.plane(Vec3::Zero(), Vec3::UnitZ());
  for (int k = 0; k < n; ++k) x.box(Vec3::Constant(0.5), 1000.0, Vec3(0, 0, 0.5 + k));
  return x;
}
}  // namespace

TEST_CASE("a body rests on the contact spring, g over omega squared deep", "[laws][soft-step]") {
  for (const double frequency : {30.0, 15.0}) {
    RigidExperiment x(soft(1.0 / 240, frequency));
    x.plane(Vec3::Zero(), Vec3::UnitZ());
    x.sphere(0.5, 1000.0, Vec3(0, 0, 0.5));
    const double first = x.energy();
    x.run_for(6.0);
    const double w = 2.0 * std::numbers::pi * frequency, sag = 0.5 - x.world.position[1].z();
    CHECK(sag == Approx(9.81 / (w * w)).epsilon(0.02));
    CHECK(x.world.velocity[1].norm() < 1e-6);
    CHECK(std::abs(x.energy() + x.dissipated - x.correction - first) < 1e-9 * first);
  }
}

TEST_CASE("contact springs are in series: n boxes sink n^2 times as deep as one", "[laws][soft-step]") {
  // between two boxes the effective mass is half, the spring half as stiff: n + 2 (1 + ... + n - 1) = n^2
  RigidExperiment five = tower(5, soft(1.0 / 240));
  five.run(20);
  CHECK_FALSE(five.work.report.solver.converged);  // on the way the impulses lag behind
  CHECK(five.work.report.solver.iterations == 4);
  five.run_for(10.0);
  const double w = 2.0 * std::numbers::pi * 30.0;
  CHECK(4.5 - five.world.position[5].z() == Approx(25.0 * 9.81 / (w * w)).epsilon(1e-3));
  CHECK(five.world.position[5].head<2>().norm() < 1e-3);
}

TEST_CASE("free flight, sliding and rebound are not those of the spring", "[laws][soft-step]") {
  RigidExperiment flight(soft(1.0 / 60));
  flight.plane(Vec3::Zero(), Vec3::UnitZ());
  flight.sphere(0.5, 1000.0, Vec3(0, 0, 10.0), Vec3(1, 0, 0));
  flight.run_for(1.0);
  CHECK(flight.world.position[1].isApprox(Vec3(1.0, 0, 10.0 - 0.5 * 9.81), 1e-12));

  RigidSettings slope = soft(1.0 / 240);
  const double angle = std::atan(0.5) + 0.1;
  slope.gravity = 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle));
  RigidExperiment slide = tower(1, slope);
  slide.run_for(1.0);
  const double v = slide.world.velocity[1].x();
  slide.run_for(1.0);
  CHECK(slide.world.velocity[1].x() - v == Approx(9.81 * (std::sin(angle) - 0.5 * std::cos(angle))).epsilon(1e-3));

  RigidExperiment bounce(soft(1.0 / 240, 30.0, 0.8));
  bounce.plane(Vec3::Zero(), Vec3::UnitZ());
  bounce.sphere(0.5, 1000.0, Vec3(0, 0, 1.5));
  double fastest = 0.0;
  while (bounce.world.time < 0.6) {
    bounce.run(1);
    fastest = std::max(fastest, bounce.world.velocity[1].z());
  }
  CHECK(fastest == Approx(0.8 * std::sqrt(2 * 9.81)).epsilon(0.03));
}

TEST_CASE("soft steps are the same bits for every thread count", "[laws][soft-step]") {
  const support::KeepThreads keep;
  const auto end = [](int threads) {
    set_thread_count(threads);
    RigidExperiment x = tower(12, soft(1.0 / 60));
    x.run(50);
    return x.world.position;
  };
  const auto one = end(1);
  for (const int threads : {2, 3, 8, 16}) CHECK(end(threads) == one);
}
