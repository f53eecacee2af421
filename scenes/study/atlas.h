/// @file atlas.h  `epafi chart --all` and `epafi limits --all`: runs every study of a folder for the atlas within a
/// bounded time, and reports figures that differ from the stored ones.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "scenes/study/study.h"

namespace epafi {

struct AtlasOrder {
  std::filesystem::path studies;           ///< folder with the studies
  std::filesystem::path atlas;             ///< where their tables and pictures stand
  std::filesystem::path work;              ///< for the runs
  double budget = 1800.0;                  ///< wall time of all studies [s]
  int jobs = 1;                            ///< cases at a time, limits only
  std::vector<std::string> only = {};      ///< names of the studies (without .toml) that are drawn; empty: all
  std::string program = "/proc/self/exe";  ///< that runs the cases
};

/// The studies of a folder that a command can run, the shortest first; charts have an `error`, maps of limits a
/// parameter.
std::vector<Study> studies_in(const std::filesystem::path& folder, bool charts);

/// Rows of a table that differ from the stored ones by more than their spread, one line each: errors (of charts) that
/// changed by more than error_spread and 1e-9 of themselves, times by more than both spreads and 20 %, kinds of failure
/// (of limits) that are others now.
std::vector<std::string> moved_rows(const std::string& stored_csv, const std::string& new_csv);

/// Runs the charts (or the limits); `say` gets a line for every case, of every row that moved and of every study that
/// the budget left out. A study may take twice an even part of what is left, a case no more than that; the repeats of
/// its timings and then its last cases fall out first. False where a study was left out.
bool draw_atlas(const AtlasOrder& order, bool charts, const std::function<void(const std::string&)>& say);

}  // namespace epafi
