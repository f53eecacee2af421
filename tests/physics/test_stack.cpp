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
