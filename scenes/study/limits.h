/// @file limits.h  `epafi limits`: where each method of a study stops working, along one or two parameters that are
/// scanned or bisected. A failure has a kind; a case that was finished earlier with the same scene is not run again.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scenes/study/case_run.h"
#include "scenes/study/study.h"

namespace epafi {

struct LimitCase {
  std::size_t method = 0;
  std::vector<double> at;  ///< values of the parameters
  std::string status;      ///< ok or failed
  std::string kind;        ///< of the failure, empty where it is ok
  std::string detail;      ///< quantity and value, or the message of the run
  std::string state_hash;
};

/// The limit of one method at one value of the first parameter (of none, where the study has one parameter).
struct Limit {
  std::size_t method = 0;
  std::optional<double> at;
  std::optional<double> last_good, first_failing;  ///< of the last parameter; empty: beyond the range
  std::string kind;                                ///< of the first failure
  std::optional<double> theory;
};

struct LimitMap {
  Study study;
  std::vector<LimitCase> cases;
  std::vector<Limit> limits;
  bool whole = true;  ///< false where the budget ended it: bisections are coarser than asked, values of scans missing
};

/// The kind of failure of a finished case under a study's `fails_when`; empty where it is good. `detail` says the
/// value.
std::string kind_of_failure(const std::vector<FailureSpec>& fails_when, const CaseResult& result, std::string& detail);

/// One case of a study of a patch: the method against the study's reference at the same values of the parameters (as
/// overrides). fails_when: pressure, area, force or patch, as for charts. A failure is "flagged" where the result is
/// marked as not valid.
LimitCase judge_patch_case(const Study& study, std::size_t method, const std::vector<std::string>& parameters,
                           const std::vector<double>& at);

/// In rounds, coarse to fine: each asks the next values of every search, `jobs` cases at a time, until study.budget is
/// spent.
LimitMap run_limits(const Study& study, const std::filesystem::path& folder, int jobs,
                    const std::function<void(const std::string&)>& say);

std::string limits_csv(const LimitMap& map);
std::string limits_json(const LimitMap& map);
/// One line per limit, with theory beside it where the study gives one.
std::string limits_verdict(const LimitMap& map);
/// limits.svg and limits.png; with several methods one picture each, limits_<method>.svg.
void draw_limits(const LimitMap& map, const std::filesystem::path& folder);

}  // namespace epafi
