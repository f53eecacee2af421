/// @file sweep.h  `epafi sweep`: the cases of a scene's [sweep], every combination of its lists. Each is a run of its
/// own in folder/case_NNNN; finished ones are skipped, so that a sweep can be spread over jobs and taken up again.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "scenes/study/case_run.h"

namespace epafi {

struct SweepPlan {
  std::string scene;
  std::vector<std::string> overrides;  ///< of every case
  std::vector<std::string> keys;
  std::vector<Case> cases;
  std::vector<std::vector<std::string>> values;  ///< by case, by key, as TOML
  std::vector<std::string> hashes;               ///< of the scene of each case
};

/// Throws SceneError where the scene has no [sweep] or a case is no valid scene.
SweepPlan plan_sweep(const std::string& scene, const std::vector<std::string>& overrides,
                     const std::filesystem::path& folder);

/// Number, settings and state of every case.
std::string list_sweep(const SweepPlan& sweep);

/// One row per case: its values and every number of its summary.
std::string collect_sweep(const SweepPlan& sweep);

}  // namespace epafi
