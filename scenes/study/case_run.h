/// @file case_run.h  Runs a scene with overrides as a process of its own, which is the command a user would type: a
/// case that crashes, hangs or eats memory takes nothing else with it, and its processor time is its own.
#pragma once
#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "viz_export/files/json_reader.h"

namespace epafi {

struct Case {
  std::vector<std::string> overrides;  ///< "KEY.PATH=VALUE"
  std::filesystem::path folder;        ///< its output
};

struct CaseLimits {
  std::string program = "/proc/self/exe";  ///< that runs the case: this one
  int threads = 1;
  double seconds = 0.0;      ///< processor time of the run per thread [s], so that a busy machine ends no case; 0: none
  bool least_output = true;  ///< no frames, no snapshot but the last
  std::optional<std::chrono::steady_clock::time_point> until = {};  ///< no case is begun later
};

/// Result of a case.
struct CaseResult {
  /// completed, bound_violated, failed, over_budget (its time limit ended it), wrong_scene, crashed, interrupted
  std::string status;
  std::string trouble;  ///< last message of the process, empty where it completed
  FlatJson summary;     ///< empty where the run wrote none
  bool completed() const { return status == "completed"; }
  double number(const std::string& name, double otherwise) const { return summary.number(name).value_or(otherwise); }
};

/// Runs one case and waits for it. The folder is made anew; FileError where it holds something else than a case.
CaseResult run_case(const std::string& scene, const Case& wanted, const CaseLimits& limits);

/// Runs all, `jobs` at a time, in order; `done(i, result)` is called as each ends, in the order of ending.
/// Returns false where an interruption ended it early.
bool run_cases(const std::string& scene, const std::vector<Case>& cases, const CaseLimits& limits, int jobs,
               const std::function<void(std::size_t, const CaseResult&)>& done);

/// Removes the cases from a folder, nothing else.
void remove_cases(const std::filesystem::path& folder);

/// The result of a case that was finished earlier with the same scene (hash); empty where there is none.
std::optional<CaseResult> finished_case(const Case& wanted, const std::string& scene_hash);

/// Command line that repeats the case.
std::string command_line(const std::string& scene, const Case& wanted, const CaseLimits& limits);

}  // namespace epafi
