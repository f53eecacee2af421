/// @file run_folder.h  Content of a folder: a run, or runs and tables of a sweep, chart, limits or patch.
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

/// Files in it that a run alone writes: it has been one, whether or not its run.h5 is there.
[[nodiscard]] bool was_run(const std::filesystem::path& folder);

/// Remaining files of a run's folder without a readable run.h5, with advice: "; whole are measures.csv ...".
[[nodiscard]] std::string what_is_left(const std::filesystem::path& folder);

/// Reason why the folder cannot be opened as a run, with the command for it. command: the one given, as "view"; file:
/// the missing one.
[[nodiscard]] std::string no_run_text(const std::filesystem::path& folder, const std::string& command,
                                      const std::string& file = "run.h5");

}  // namespace epafi
