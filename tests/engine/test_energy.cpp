#include "engine/step/energy.h"

#include <cmath>

#include "tests/support/catch.h"

using namespace epafi;

namespace {

World resting_body(double mass) {
  World world(Columns{.force = false});
  Body b;
  b.mass = mass;
  world.add(b);
  world.velocity[0] = Vec3(2, 0, 0);
  return world;
}

StepReport taking(double energy, bool impulses = false) {
  StepReport r;
  r.dissipated = energy;
  r.has_solver = impulses;
  return r;
}

}  // namespace

TEST_CASE("what contacts give is a gain and stays in the error: dissipation never falls", "[engine][energy]") {
  World world = resting_body(1.0);  // 2 J
  EnergyLedger ledger;
  ledger.start(world, {});
  ledger.add(taking(1.0));
  world.velocity[0].x() = std::sqrt(2.0);  // 1 J
  ledger.measure(world);
  CHECK(ledger.relative_error() == Approx(0.0).margin(1e-12));
  ledger.add(taking(-0.5));
  world.velocity[0].x() = std::sqrt(3.0);  // 1.5 J
  const Energy gave = ledger.measure(world);
  CHECK(gave.dissipated == 1.0);
  CHECK(gave.gained == Approx(0.5));
  CHECK(ledger.relative_error() == Approx(0.25));  // 0.5 of 2 J
  ledger.add(taking(0.7));
  CHECK(ledger.last().dissipated == Approx(1.2));
  CHECK(ledger.last().gained == Approx(0.5));  // the most that there was
}

TEST_CASE("what dashpots were booked with too early is no gain, what falls further is", "[engine][energy]") {
  World world = resting_body(1.0);
  EnergyLedger ledger;
  ledger.start(world, {});
  StepReport early = taking(1.0);
  early.losses.viscous = 1.0;
  ledger.add(early);
  for (const double back : {-0.3, -0.7}) {
    ledger.add(taking(back));
    CHECK(ledger.last().gained == 0.0);
  }
  CHECK(ledger.last().dissipated == Approx(0.0).margin(1e-15));  // what the bodies have lost
  ledger.add(taking(-0.25));
  CHECK(ledger.last().gained == Approx(0.25));
  CHECK(ledger.last().dissipated == Approx(0.0).margin(1e-15));
}

TEST_CASE("errors are held against what adhesion stores, too, though it is negative", "[engine][energy]") {
  for (const double stored : {-1e-3, -2.0, -1e6}) {
    World world = resting_body(1.0);
    world.velocity[0] = Vec3::Zero();
    EnergyLedger ledger;
    StepReport holds;
    holds.elastic = stored;
    ledger.start(world, holds);
    holds.elastic = 0.9 * stored;  // a tenth of it comes from nowhere
    ledger.add(holds);
    ledger.measure(world);
    CHECK(ledger.relative_error() == Approx(0.1));
  }
}

TEST_CASE("gains below a thousandth of one step of free fall are what solvers leave", "[engine][energy]") {
  const double mass = 3.0, fall = 0.04, noise = 1e-3 * 0.5 * mass * fall * fall;
  for (const double part : {0.5, 2.0}) {
    World world = resting_body(mass);
    EnergyLedger ledger;
    ledger.start(world, {});
    ledger.add(taking(-part * noise, true), fall);
    const double before = 0.5 * mass * 4.0;
    world.velocity[0].x() = std::sqrt(2.0 * (before + part * noise) / mass);
    ledger.measure(world);
    CHECK(ledger.relative_error() * (before + 0.5 * mass * fall * fall) ==
          Approx(part > 1.0 ? noise * (part - 1.0) : 0.0).margin(1e-9 * noise + 1e-13));
  }
}

TEST_CASE("work that contacts take counts in the reference, what contacts alone took does not", "[engine][energy]") {
  for (const double work : {0.0, 1.0, 100.0}) {
    World world = resting_body(1.0);  // 2 J
    EnergyLedger ledger;
    ledger.start(world, {});
    StepReport driven = taking(50.0);
    driven.work = work;
    ledger.add(driven);
    world.velocity[0].x() = 3.0;  // 4.5 J
    ledger.measure(world);
    CHECK(ledger.relative_error() == Approx((4.5 - 2.0 + 50.0 - work) / (4.5 + std::min(work, 50.0))));
  }
}
