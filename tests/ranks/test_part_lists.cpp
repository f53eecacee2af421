// Lists of a part end a step before one process would see it; what they teach about margins must be the same.
#include "engine/ranks/shared_list.h"
#include "ranks/communicator.h"
#include "tests/support/catch.h"
#include "tests/support/library_scenes.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// How many lists a bed makes while it falls in and comes to rest below.
std::uint64_t lists_of_bed(const std::vector<std::string>& overrides, bool is_part) {
  SceneRun run = prepare_scene(library("bed/bed.toml"), overrides);
  Simulation& sim = run.simulation();
  sim.sort_interval = 1000000;
  sim.start();
  World& world = sim.world;
  if (is_part)
    for (Slot s = 0; s < world.size(); ++s)
      world.owner.push_back(world.is_movable(s) ? World::here : World::everywhere);
  auto& list = dynamic_cast<SharedList&>(*sim.pipeline.broad_phase);
  for (int k = 0; k < 2500; ++k) {
    REQUIRE_FALSE(sim.advance(false, true));
    if (is_part) list.end_with_others(list.predicted_end());
  }
  return sim.work.pairs.generation;
}

}  // namespace

TEST_CASE("a part learns margins from its lists as one process does: it makes as many lists") {
  if (rank_number() != 0) return;
  const auto seed = GENERATE(7, 8);
  const std::vector<std::string> overrides{"params.n=3000", "run.seed=" + std::to_string(seed)};
  const std::uint64_t want = lists_of_bed(overrides, false), have = lists_of_bed(overrides, true);
  INFO("seed " << seed << ": " << have << " lists of a part, " << want << " of one process");
  CHECK(want > 100);
  CHECK(have <= want + want / 20);
}
