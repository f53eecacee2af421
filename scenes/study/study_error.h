/// @file study_error.h  What a finished case says under the error measure of a study.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "scenes/study/case_run.h"
#include "scenes/study/study.h"

namespace epafi {

/// Components of the measured quantity, by name; empty where the case does not have it.
std::map<std::string, double> measured(const ErrorSpec& error, const CaseResult& result);

/// Root of the mean square distance of body centres between the last snapshots of two runs [m]; empty where bodies
/// differ.
std::optional<double> distance(const std::filesystem::path& run, const std::filesystem::path& reference);

/// Reference of the errors of a case.
struct Yardstick {
  std::map<std::string, double> values;  ///< of the reference run; empty where there is none
  std::filesystem::path folder;          ///< of the reference run, for `distance`
};

/// The error of a case, >= 0; empty where it cannot be had.
std::optional<double> study_error(const ErrorSpec& error, const CaseResult& result, const std::filesystem::path& folder,
                                  const Yardstick& yardstick);

}  // namespace epafi
