/// @file run_folder.h  What lies in a folder: a run of its own, or runs and tables of a sweep, chart, limits or patch.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace epafi {

/// Files of an ending in the folder itself, by name.
[[nodiscard]] std::vector<std::filesystem::path> files_with(const std::filesystem::path& folder,
                                                            const std::string& ending);

/// Folders in it that hold a run, by name: finished, cut or going on. file: only those that hold this one.
[[nodiscard]] std::vector<std::filesystem::path> runs_in(const std::filesystem::path& folder,
                                                         const std::string& file = {});

/// Why the folder cannot be opened as a run, and what takes it instead. command: that was asked for, as "view".
[[nodiscard]] std::string no_run_text(const std::filesystem::path& folder, const std::string& command);

}  // namespace epafi
