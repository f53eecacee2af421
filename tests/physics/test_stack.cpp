// The box stack of the library by PGS with 50 iterations at dt = 1/240 s.
#include "engine/state_snapshot.h"
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
    const World& world = run.simulation().world;
    CHECK(measure_overlap(world, {world, run.simulation().work.contacts}, *run.assembly->shapes).max < 1e-3);
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

TEST_CASE("a pyramid at rest needs no iterations, and a restart amid them gives the same bits", "[physics][stack][restart]") {
  const std::vector<std::string> set{"params.n=20", "run.time_step=0.016666666666666666",
                                     "contact.nonsmooth.tolerance=1e-6", "contact.nonsmooth.solver=newton",
                                     "run.duration=5"};
  auto run = run_scene("stacking/pyramid.toml", set, 150);
  Simulation& sim = run.simulation();
  StateSnapshot half;
  int iterations = 0, calmed = 0;
  double start = 0.0, worst = 0.0;
  while (sim.steps() < 300) {
    if (sim.steps() == 200) half.save([&](StateVisitor& v) { sim.visit(v); });
    REQUIRE(!sim.advance(false));
    const SolverReport& solver = sim.work.report.solver;
    iterations += solver.iterations, worst = std::max(worst, solver.residual);
    if (solver.residual < 0.5 * start && solver.iterations == 0) ++calmed;  // the last factor took velocities out
    start = solver.residual;
  }
  CHECK(iterations == 0);  // 51 where only solutions are calmed
  CHECK(calmed > 0);
  CHECK(worst <= 1e-7);  // what is no start is solved
  CHECK(kinetic_energy(sim.world) < 1e-9);
  auto again = prepare_scene(library("stacking/pyramid.toml"), set);
  half.restore([&](StateVisitor& v) { again.simulation().visit(v); });
  again.advance_to(300);
  CHECK(again.hash() == run.hash());
}
