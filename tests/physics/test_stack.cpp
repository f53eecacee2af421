// The box stack of the library by PGS with 50 iterations at dt = 1/240 s.
#include "scenes/monitor.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

TEST_CASE("ten boxes stand for 10 s: drift below 5 mm, overlap below a thousandth of the edge", "[physics][stack]") {
  for (const std::string jitter : {"params.jitter=0", "params.jitter=0.002"}) {
    INFO(jitter);
    auto run = run_scene("stacking/stack.toml", {jitter});
    CHECK(run.failure.empty());
    CHECK(run.largest("drift", "distance") < 5e-3);
    CHECK(measure_overlap(run.simulation().world, run.simulation().work.contacts, *run.assembly->shapes).max < 1e-3);
    CHECK(kinetic_energy(run.simulation().world) < 1e-6);
  }
}

TEST_CASE("a stack of 30 at rest starts from its solution: hardly an iteration in 200 steps", "[physics][stack]") {
  auto run = run_scene("stacking/stack.toml", {"params.n=30", "contact.nonsmooth.tolerance=1e-6",
                                               "contact.nonsmooth.solver=newton", "run.duration=3"});
  Simulation& sim = run.simulation();
  int iterations = 0;
  double residual = 0.0;
  for (int k = 0; k < 200; ++k) {
    REQUIRE(!sim.advance(false));
    iterations += sim.work.report.solver.iterations;
    residual = std::max(residual, sim.work.report.solver.residual);
  }
  CHECK(iterations <= 20);  // 100 before calmest() of laws/nonsmooth/nonsmooth_contact.cpp
  CHECK(residual < 1e-6);
  CHECK(kinetic_energy(sim.world) < 1e-9);
}
