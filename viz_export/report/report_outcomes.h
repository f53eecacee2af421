/// @file report_outcomes.h  What came out of a sweep over what was swept, as plots of its report.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "viz_export/report/report_cases.h"

namespace epafi {

/// A plot for each of the first outcomes that differ between the cases, over the override with the most values; a
/// colour for each choice of the other overrides. Empty where no override is a number that differs. target: the page,
/// beside which the plots are drawn. Without gnuplot a line says so.
[[nodiscard]] std::string outcomes_html(const std::vector<ReportCase>& cases, const std::filesystem::path& target);

}  // namespace epafi
