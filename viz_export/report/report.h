/// @file report.h  One HTML page of a run, complete in itself: no script, no file beside it, no network.
#pragma once
#include <filesystem>

namespace epafi {

/// Reads summary.json and run.h5 of `folder` (without a summary of a run that was cut or goes on: what its files tell),
/// or the runs and tables of a sweep, chart, limits or patch; writes `page` (empty: folder/report.html) and returns its
/// path. Curves are drawn by gnuplot; where it is absent the page says so and gives their last values only. Throws
/// FileError.
std::filesystem::path write_report(const std::filesystem::path& folder, const std::filesystem::path& page = {});

}  // namespace epafi
