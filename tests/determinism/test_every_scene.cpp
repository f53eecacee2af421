// Every scene of the library, shortened: one hash for every number of threads, a restart in the middle gives the same
// bits, the ledger closes, and the hash is the one written down (golden: labelled so, compared by Release and Debug
// builds alike).
#include "engine/state/state_snapshot.h"
#include "engine/threads/parallel.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/support/library_scenes.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

std::string run_hash(const Short& s, const std::string& method, int threads) {
  set_thread_count(threads);
  std::vector<std::string> overrides = s.overrides;
  if (method != "as-written") overrides.push_back("contact.method=" + method);
  return run_scene(s.scene, overrides, s.steps).hash();
}

}  // namespace

TEST_CASE("every library scene has one hash for 1, 2 and 4 threads, the golden one", "[determinism][long]") {
  const auto golden = golden_hashes();
  const support::KeepThreads keep;
  for (const auto& scene : all_scenes()) {
    const Short s = shortened(scene);
    const std::string hash = run_hash(s, "as-written", 1);
    INFO(scene << " as-written " << hash << "  (the line for tests/golden/state_hashes.txt, if the change is meant)");
    for (int threads : {2, 4}) CHECK(run_hash(s, "as-written", threads) == hash);
    const auto found = golden.find(scene + " as-written");
    CHECK((found != golden.end() ? found->second : std::string("missing")) == hash);
  }
}

TEST_CASE("every library scene has the golden hash for 3, 7, 8 and 16 threads", "[determinism][slow]") {
  const auto golden = golden_hashes();
  const support::KeepThreads keep;
  for (const auto& scene : all_scenes()) {
    INFO(scene);
    for (int threads : {3, 7, 8, 16})
      CHECK(run_hash(shortened(scene), "as-written", threads) == golden.at(scene + " as-written"));
  }
}

TEST_CASE("every library scene continues from its state in the middle with the same bits",
          "[determinism][restart][long]") {
  for (const auto& scene : all_scenes()) {
    const Short s = shortened(scene);
    INFO(scene);
    SceneRun straight = prepare_scene(library(scene), s.overrides);
    straight.simulation().start();
    straight.advance_to(s.steps / 2);
    StateSnapshot middle;
    middle.save([&](StateVisitor& v) { straight.simulation().visit(v); });
    straight.advance_to(s.steps);
    SceneRun resumed = prepare_scene(library(scene), s.overrides);
    middle.restore([&](StateVisitor& v) { resumed.simulation().visit(v); });
    resumed.advance_to(s.steps);
    CHECK(resumed.hash() == straight.hash());
    CHECK(resumed.energy_error() == straight.energy_error());
  }
}

TEST_CASE("a state in which bodies are sorted at once continues with the same bits", "[determinism][restart]") {
  // Springs of spheres on walls come in before anybody knows the walls, and go to other slots.
  constexpr std::uint64_t cut = 3000;
  for (const char* count : {"params.n=200", "params.n=350", "params.n=500"})
    for (const bool rolls : {false, true}) {
      std::vector<std::string> overrides{count};
      if (rolls) overrides.insert(overrides.end(), {"contact.smooth.rolling=spring", "contact.rolling_friction=0.1"});
      INFO(count << (rolls ? ", rolling" : ""));
      SceneRun straight = prepare_scene(library("bed/bed.toml"), overrides);
      REQUIRE(cut % straight.simulation().sort_interval == 0);
      straight.simulation().start();
      straight.advance_to(cut);
      StateSnapshot middle;
      middle.save([&](StateVisitor& v) { straight.simulation().visit(v); });
      straight.advance_to(cut + 20);
      SceneRun resumed = prepare_scene(library("bed/bed.toml"), overrides);
      middle.restore([&](StateVisitor& v) { resumed.simulation().visit(v); });
      resumed.advance_to(cut + 20);
      CHECK(resumed.hash() == straight.hash());
    }
}

TEST_CASE("every library scene keeps its ledger closed", "[determinism][energy][long]") {
  for (const auto& scene : all_scenes()) {
    const Short s = shortened(scene);
    SceneRun run = run_scene(s.scene, s.overrides, s.steps);
    INFO(scene << ": " << run.failure);
    CHECK(run.failure.empty());
    CHECK(std::abs(run.energy_error()) < 1e-2);
  }
}
