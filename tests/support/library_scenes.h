/// @file library_scenes.h  Every scene of the library, shortened to what a test has time for, and its golden hash.
#pragma once
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "tests/support/scene_run.h"

namespace epafi::experiments {

struct Short {
  std::string scene;                   ///< relative to scenes/library
  std::vector<std::string> overrides;  ///< smaller where the scene is large
  std::uint64_t steps;
};

/// Large scenes are made smaller, all are cut after some hundred steps in which contacts form and slide.
inline Short shortened(const std::string& scene) {
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
inline bool is_patch_file(const std::filesystem::path& path) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);)
    if (line.rfind("[patch]", 0) == 0) return true;
  return false;
}

inline std::vector<std::string> all_scenes() {
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
inline std::map<std::string, std::string> golden_hashes() {
  std::ifstream in(std::string(EPAFI_SOURCE_DIR) + "/tests/golden/state_hashes.txt");
  std::map<std::string, std::string> out;
  std::string scene, method, hash;
  while (in >> scene >> method >> hash) out[scene + " " + method] = hash;
  return out;
}

}  // namespace epafi::experiments
