/// @file report_cases.h  The finished cases of a folder, as tables of its report.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "viz_export/files/json_reader.h"
#include "viz_export/measures/measure_units.h"

namespace epafi {

/// A finished case.
struct ReportCase {
  std::string name;
  FlatJson summary;
  std::map<std::string, std::string> set{};       ///< overrides by key
  std::map<std::string, MeasureUnit> measured{};  ///< "heap.z" and what it is
  std::string title{};
};

/// It came to an end of its own: it neither goes on nor was cut off, interrupted or made unreadable.
bool has_ended(const ReportCase& one);

/// Damaged or missing run files leave only the summary.
ReportCase read_case(const std::filesystem::path& folder);

/// Table of cases: first the overrides that differ, then facts of each run, then measures at the end.
std::string cases_html(const std::vector<ReportCase>& cases);

/// List of warnings: the first three, the others collapsed.
std::string warnings_html(const std::vector<ReportCase>& cases);

}  // namespace epafi
