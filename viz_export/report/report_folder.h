/// @file report_folder.h  One HTML page of a sweep, a chart, limits or patches: their tables and pictures.
#pragma once
#include <filesystem>

namespace epafi {

/// It holds a table (CSV), or cases of a sweep.
[[nodiscard]] bool has_tables(const std::filesystem::path& folder);

/// Writes `page` (empty: folder/report.html) and returns its path. Throws FileError.
std::filesystem::path write_folder_report(const std::filesystem::path& folder, const std::filesystem::path& page = {});

}  // namespace epafi
