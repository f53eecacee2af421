// The box stack of the library by its default solver and step.
#include "engine/state/state_snapshot.h"
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

// `auto` begins where newton had the last word: 38 iterations a step before, sweeps that never ended.
TEST_CASE("a pyramid at rest needs no iterations, and a restart amid them gives the same bits",
          "[physics][stack][restart][long]") {
  for (const std::string solver : {"newton", "auto"}) {
    INFO(solver);
    const std::vector<std::string> set{"params.n=20",
                                       "run.time_step=0.016666666666666666",
                                       "contact.nonsmooth.tolerance=1e-6",
                                       "contact.nonsmooth.iterations=1000",
                                       "contact.nonsmooth.solver=" + solver,
                                       "run.duration=5"};
    auto run = run_scene("stacking/pyramid.toml", set, 150);
    Simulation& sim = run.simulation();
    StateSnapshot half;
    int iterations = 0, calmed = 0;
    double start = 0.0, worst = 0.0;
    while (sim.steps() < 300) {
      if (sim.steps() == 200) half.save([&](StateVisitor& v) { sim.visit(v); });
      REQUIRE(!sim.advance(false));
      const SolverReport& report = sim.work.report.solver;
      iterations += report.iterations;
      worst = std::max(worst, report.residual);
      if (report.residual < 0.5 * start && report.iterations == 0) ++calmed;  // the last factor took velocities out
      start = report.residual;
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
}

TEST_CASE("stacks apart come to rest each by its own factor, and a restart gives the same bits",
          "[physics][stack][restart]") {
  const std::string text = R"(title = "Three stacks"
run = { duration = 2.0, time_step = 4e-3, output_interval = 1.0 }
world = { gravity = [0, 0, -9.81] }
material.stone = { density = 1000.0, youngs_modulus = "100 MPa", poissons_ratio = 0.2 }
contact = { method = "nonsmooth", restitution = 0.0, friction = 0.5, nonsmooth = { solver = "auto" } }
[[body]]
shape = { half_space = { normal = [0, 0, 1] } }
material = "stone"
fixed = true
)";
  std::string stacks;
  for (const int n : {2, 12, 30})
    stacks += "[[body]]\nrepeat = " + std::to_string(n) +
              "\nshape = { box = { size = [1, 1, 1] } }\nmaterial = \"stone\"\n" +
              "position = [\"= " + std::to_string(5 * n) + "\", 0, \"= 1.0001*i + 0.5\"]\n";
  auto run = start_text(text + stacks);
  Simulation& sim = run.simulation();
  StateSnapshot early, late;
  int settling = 0, resting = 0;
  while (sim.steps() < 400) {
    if (sim.steps() == 4) early.save([&](StateVisitor& v) { sim.visit(v); });
    if (sim.steps() == 250) late.save([&](StateVisitor& v) { sim.visit(v); });
    REQUIRE(!sim.advance(false));
    (sim.steps() <= 200 ? settling : resting) += sim.work.report.solver.iterations;
  }
  CHECK(settling > 0);
  CHECK(resting == 0);
  CHECK(kinetic_energy(sim.world) < 1e-9);
  for (StateSnapshot* const from : {&early, &late}) {
    auto again = start_text(text + stacks);
    from->restore([&](StateVisitor& v) { again.simulation().visit(v); });
    again.advance_to(400);
    CHECK(again.hash() == run.hash());
  }
}

TEST_CASE("a state that is saved at every step changes nothing of a run in which auto tries newton",
          "[physics][restart]") {
  const std::string scene = "simbenchmark/rolling.toml";
  auto run = run_scene(scene, {}, 400), watched = prepare_scene(library(scene), {});
  watched.simulation().start();
  while (watched.simulation().steps() < 400) {
    StateSnapshot every;
    every.save([&](StateVisitor& v) { watched.simulation().visit(v); });
    REQUIRE(!watched.simulation().advance(false));
  }
  CHECK(watched.hash() == run.hash());
}

TEST_CASE("scenes of the library meet the tolerance that they ask for in every step", "[physics][library][long]") {
  struct Shortened {
    std::string scene;
    std::vector<std::string> sets;
    std::uint64_t steps;
  };
  const Shortened scenes[] = {{"stacking/pyramid.toml", {}, 100},
                              {"stacking/stack.toml", {}, 100},
                              {"tutorials/03_stack.toml", {}, 100},
                              {"tutorials/04_stones.toml", {"params.n=6"}, 220},
                              {"hopper/pellets.toml", {"params.n=60", "params.open_at=0.09"}, 150}};
  for (const Shortened& s : scenes) {
    INFO(s.scene);
    SceneRun run = prepare_scene(library(s.scene), s.sets);
    Simulation& sim = run.simulation();
    sim.start();
    std::uint64_t open = 0;
    while (sim.steps() < s.steps) {
      REQUIRE(!sim.advance(false));
      open += !sim.work.report.solver.converged;
    }
    CHECK(open == 0);
  }
}
