// Springs in non-smooth contact: no creep beside contacts that stick, balance from time 0 on, and the limit of their
// step.
#include "engine/step/energy.h"
#include "laws/springs/spring_forces.h"
#include "tests/support/catch.h"
#include "tests/support/rigid_experiment.h"

using namespace epafi;
using namespace epafi::test;

namespace {

/// Puts springs over the contact model; the world is complete.
void hang(RigidExperiment& run, const std::vector<SpringElement>& springs) {
  run.run(0);  // makes the stages
  run.pipeline.contact_model =
      make_spring_forces(springs, std::make_shared<StraightWay>(), false, std::move(run.pipeline.contact_model));
}

SpringElement spring_on(const RigidExperiment& run, Slot s, double stiffness) {
  SpringElement e;
  e.body = run.world.id[s];
  e.stiffness = Vec3::Constant(stiffness);
  return e;
}

}  // namespace

TEST_CASE("a box pulled by a spring below its friction stays: step, stiffness, arm, solver, warm start",
          "[laws][springs][nonsmooth]") {
  // mass 1 kg on mu = 0.5: 4.9 N hold it, less where the spring lifts it
  for (const double dt : {1e-4, 1e-3, 1e-2})
    for (const double stiffness : {1.0, 100.0})
      for (const Vec3& pull : {Vec3(2, 0, 0), Vec3(-1, 1.5, 0), Vec3(2, 0, 3), Vec3(2, -1, -4)})
        for (const bool warm : {true, false}) {
          RigidSettings s{.friction = 0.5, .dt = dt, .solver = warm ? "newton" : "nsgs"};
          s.parameters.set("tolerance", 1e-11);
          s.parameters.set("iterations", 500.0);
          s.parameters.set("warm_start", warm);
          RigidExperiment run(s);
          run.plane(Vec3::Zero(), Vec3::UnitZ());
          const Slot box = run.box(Vec3::Constant(0.05), 1000, Vec3(0, 0, 0.05));
          SpringElement e = spring_on(run, box, stiffness);
          e.attachment = Vec3(0, 0, -0.05);
          e.preload = pull;
          hang(run, {e});
          run.run(100);
          INFO("dt " << dt << " k " << stiffness << " pull " << pull.transpose() << " warm " << warm);
          CHECK((run.world.position[box] - Vec3(0, 0, 0.05)).norm() < 1e-9);
          CHECK(run.world.velocity[box].norm() < 1e-9);
        }
}

TEST_CASE("a box on a table that is shaken sideways goes with it while friction holds", "[laws][nonsmooth]") {
  // 0.4 g of acceleration, mu = 0.5: the slip is that of rounding
  RigidSettings s{.friction = 0.5, .dt = 1e-3, .solver = "newton"};
  s.parameters.set("tolerance", 1e-11);
  s.parameters.set("iterations", 500.0);
  RigidExperiment run(s);
  const Slot table = run.plane(Vec3::Zero(), Vec3::UnitZ());
  const Slot box = run.box(Vec3(0.05, 0.05, 0.02), 1000, Vec3(0, 0, 0.02));
  double slip = 0.0;
  for (int k = 0; k < 1000; ++k) {
    run.world.velocity[table] = Vec3(0.4 * 9.81 / 20.0 * std::sin(20.0 * k * s.dt), 0, 0);
    run.run(1);
    slip = std::max(slip, (run.world.velocity[box] - run.world.velocity[table]).norm());
  }
  CHECK(slip < 1e-9);
}

TEST_CASE("a weight at rest on a preloaded spring has a balance from time 0 on", "[laws][springs][nonsmooth]") {
  RigidExperiment run(RigidSettings{});
  const Slot box = run.box(Vec3::Constant(0.05), 1000, Vec3(0, 0, 1));
  SpringElement e = spring_on(run, box, 10.0);
  e.preload = Vec3(0, 0, 9.81);
  hang(run, {e});
  StepReport start;
  run.pipeline.contact_model->store(run.world, start);
  CHECK(start.elastic == Approx(9.81 * 9.81 / 20.0));
  EnergyLedger ledger;
  ledger.start(run.world, start);
  for (int k = 0; k < 100; ++k) {
    run.run(1);
    ledger.add(run.work.report);
    ledger.measure(run.world);
    REQUIRE(std::abs(ledger.relative_error()) < 1e-12);
  }
  CHECK(run.world.position[box].z() == Approx(1.0).epsilon(1e-13));
}

TEST_CASE("springs let a body swing with its frequency, dampers take what the ledger says",
          "[laws][springs][nonsmooth]") {
  for (const double damping : {0.0, 2.0}) {
    RigidExperiment run(RigidSettings{.dt = 1e-3, .gravity = Vec3::Zero()});
    const Slot box = run.box(Vec3::Constant(0.05), 1000, Vec3::Zero(), Vec3(1, 0, 0));
    SpringElement e = spring_on(run, box, 100.0);
    e.damping = Vec3::Constant(damping);
    hang(run, {e});
    StepReport start;
    run.pipeline.contact_model->store(run.world, start);
    EnergyLedger ledger;
    ledger.start(run.world, start);
    for (int k = 0; k < 500; ++k) {
      run.run(1);
      ledger.add(run.work.report);
      ledger.measure(run.world);
      REQUIRE(std::abs(ledger.relative_error()) < 1e-4);  // (omega dt)^2
    }
    // x = v0/w exp(-c t/2m) sin(w t), w^2 = k/m - (c/2m)^2, t = 0.5 s
    const double rate = 0.5 * damping, w = std::sqrt(100.0 - rate * rate);
    CHECK(run.world.position[box].x() ==
          Approx(std::exp(-rate * 0.5) * std::sin(0.5 * w) / w).margin(damping > 0.0 ? 2e-4 : 1e-5));
  }
}

TEST_CASE("the largest rate of springs counts arms, both ends and chains as they are", "[laws][springs]") {
  const StraightWay way;
  const auto rates = [&](const RigidExperiment& run, const std::vector<SpringElement>& springs) {
    return spring_rates(springs, run.world, way).square;
  };
  RigidExperiment run(RigidSettings{});
  const Slot a = run.box(Vec3::Constant(0.05), 1000, Vec3::Zero());                   // 1 kg
  const Slot b = run.box(Vec3::Constant(0.05), 4000, Vec3(1, 0, 0));                  // 4 kg
  const Slot rod = run.box(Vec3(0.5, 0.01, 0.01), 2500, Vec3(0, 0, 3), Vec3::Zero(),  // 1 kg
                           Quat(Eigen::AngleAxisd(0.4, Vec3::UnitY())));
  SpringElement e = spring_on(run, a, 1e6);
  CHECK(rates(run, {e}) == Approx(1e6).epsilon(1e-6));
  e.to = run.world.id[b];
  e.attachment = Vec3(0.5, 0, 0);
  const double arm = 0.25 * (6.0 / 0.01 + 6.0 / 0.04);  // both half a metre off, I = m a^2/6 with a = 0.1 m
  CHECK(rates(run, {e}) == Approx(1e6 * (1.0 + 0.25 + arm)).epsilon(1e-3));
  SpringElement pivot =
      spring_on(run, rod, 1e6);  // of the pendulum: k (1/m + (l/2)^2/I), not k (l/2)^2 over its least moment
  pivot.attachment = Vec3(0.5, 0, 0);
  CHECK(rates(run, {pivot}) == Approx(1e6 * (1.0 + 0.25 * 3.0 / (0.25 + 0.0001))).epsilon(1e-3));
  // three equal masses in a row: 3 k/m
  RigidExperiment row(RigidSettings{});
  for (int k = 0; k < 3; ++k) row.sphere(std::cbrt(0.75e-3 / std::numbers::pi), 1000, Vec3(0, 0, k));
  SpringElement first = spring_on(row, 0, 500.0), second = spring_on(row, 1, 500.0);
  first.to = row.world.id[1];
  second.to = row.world.id[2];
  first.stiffness = second.stiffness = Vec3(0, 0, 500.0);
  CHECK(rates(row, {first, second}) == Approx(1500.0).epsilon(1e-3));
}

TEST_CASE("steps of impulses are stable up to the limit and not beyond", "[laws][springs]") {
  for (const double damping : {0.0, 5.0, 60.0, 400.0})
    for (const double factor : {0.98, 1.02}) {
      const double limit = impulse_limit({1e4, damping});
      RigidExperiment run(RigidSettings{.dt = factor * limit, .gravity = Vec3::Zero()});
      const Slot box = run.box(Vec3::Constant(0.05), 1000, Vec3::Zero(), Vec3(1, 0, 0));
      SpringElement e = spring_on(run, box, 1e4);
      e.damping = Vec3::Constant(damping);
      hang(run, {e});
      run.run(2000);
      INFO("damping " << damping << " at " << factor);
      CHECK((run.world.velocity[box].norm() < 100.0) == (factor < 1.0));
    }
}
