// Every scene of the library, shortened: one hash for every number of threads, a restart in the middle gives the same
// bits, the ledger closes, and the hash is the one written down (golden: labelled so, compared by Release and Debug
// builds alike).
#include <filesystem>
#include <fstream>

#include "engine/state/state_snapshot.h"
#include "engine/threads/parallel.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

struct Short {
  std::string scene;                   ///< relative to scenes/library
  std::vector<std::string> overrides;  ///< smaller where the scene is large
  std::uint64_t steps;
};

/// Large scenes are made smaller, all are cut after some hundred steps in which contacts form and slide.
Short shortened(const std::string& scene) {
  if (scene == "hopper/hopper.toml") return {scene, {"params.n=400", "params.open_at=0.09"}, 2400};
  if (scene == "hopper/pellets.toml") return {scene, {"params.n=120", "params.open_at=0.09"}, 150};
  if (scene == "bed/bed.toml") return {scene, {"params.n=400"}, 1200};
  if (scene == "pile/polyhedra.toml") return {scene, {"params.n=60"}, 150};
  // elastic, so that the ledger is compared with an energy that stays
  if (scene.rfind("granular/hard", 0) == 0)
    return {scene, {"params.n=40", "params.start=0.06", "params.speed=2.0"}, 400};
  if (scene == "granular/jammed_capsules.toml" || scene == "granular/jammed_ellipsoids.toml")
    return {scene, {"contact.restitution=1"}, 60};
  if (scene == "granular/jammed_spheres.toml")
    return {scene, {"params.n=40", "contact.restitution=1", "params.start=0.06"}, 400};
  if (scene == "granular/incline_flow.toml") return {scene, {"params.layers=6", "params.lx=4", "params.ly=4"}, 1200};
  if (scene == "granular/column_collapse.toml")
    return {scene, {"params.l0=5", "params.w=4", "params.open_at=0.02", "params.a=1.0"}, 1200};
  if (scene == "granular/orifice.toml") return {scene, {"params.n=300", "params.height=8"}, 1500};
  if (scene == "granular/silo.toml") return {scene, {"params.n=200", "params.pour=0.03", "params.lift_at=0.3"}, 15000};
  if (scene == "tutorials/01_first_impact.toml") return {scene, {"params.drop=1e-6"}, 1400};
  if (scene == "tutorials/02_hopper.toml") return {scene, {"params.n=150", "params.open_at=0.06"}, 600};
  if (scene == "tutorials/03_stack.toml") return {scene, {"params.mu=0.1"}, 150};
  if (scene == "tutorials/04_stones.toml") return {scene, {"params.n=6"}, 250};
  if (scene == "tutorials/05_sweep.toml") return {scene, {"params.n=60"}, 1000};
  // the ones that stand have no energy to compare an error with: they are made to fall
  if (scene == "stability/cards.toml") return {scene, {"params.mu_floor=0.1"}, 200};
  if (scene == "stability/sphere_pile.toml") return {scene, {"params.mu=0.2"}, 200};
  if (scene == "stages/press.toml") return {scene, {}, 6000};
  if (scene == "stages/drum.toml")
    return {scene, {"params.n=60", "material.grain.youngs_modulus=1e5", "run.time_step=1e-4"}, 1000};
  if (scene == "stages/tilted_arch.toml") return {scene, {"params.ratio=0.08"}, 300};
  if (scene == "stability/arch.toml") return {scene, {"params.ratio=0.08"}, 300};
  if (scene == "stability/tower.toml") return {scene, {"params.floors=2"}, 150};
  return {scene, {}, 300};
}

/// Cases of `epafi patch` are statics: no steps, no hash.
bool is_patch_file(const std::filesystem::path& path) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);)
    if (line.rfind("[patch]", 0) == 0) return true;
  return false;
}

std::vector<std::string> all_scenes() {
  std::vector<std::string> scenes;
  const std::filesystem::path root = library("");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    const auto path = std::filesystem::relative(entry.path(), root);
    if (path.extension() == ".toml" && path.string().find("studies") == std::string::npos &&
        !is_patch_file(entry.path()))
      scenes.push_back(path.string());
  }
  std::sort(scenes.begin(), scenes.end());
  return scenes;
}

/// scene method hash, one line each.
std::map<std::string, std::string> golden_hashes() {
  std::ifstream in(std::string(EPAFI_SOURCE_DIR) + "/tests/golden/state_hashes.txt");
  std::map<std::string, std::string> out;
  std::string scene, method, hash;
  while (in >> scene >> method >> hash) out[scene + " " + method] = hash;
  return out;
}

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
