#include "viz_export/files/run_folder.h"

#include <fmt/format.h>

#include <algorithm>

#include "viz_export/files/run_mark.h"
#include "viz_export/measures/measure_rows.h"

namespace epafi {

namespace fs = std::filesystem;

std::vector<fs::path> files_with(const fs::path& folder, const std::string& ending) {
  std::vector<fs::path> out;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none))
    if (entry.is_regular_file() && entry.path().extension() == ending) out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<fs::path> runs_in(const fs::path& folder, const std::string& file) {
  const std::vector<std::string> any =
      file.empty() ? std::vector<std::string>{"summary.json", "run.h5"} : std::vector<std::string>{file};
  std::vector<fs::path> out;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const auto holds = [&](const std::string& name) { return fs::exists(entry.path() / name, none); };
    if (std::any_of(any.begin(), any.end(), holds)) out.push_back(entry.path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

bool was_run(const fs::path& folder) {
  std::error_code none;
  for (const char* name : {"summary.json", "checkpoint.h5", "progress.csv", ".running"})
    if (fs::exists(folder / name, none)) return true;
  return false;
}

std::string what_is_left(const fs::path& folder) {
  std::string out, whole;
  const auto add = [&](const std::string& text) { whole += (whole.empty() ? "" : ", ") + text; };
  const auto rows = measure_rows(folder / "measures.csv");
  if (!rows.empty()) add(fmt::format("measures.csv up to t = {:.6g} s", rows.back().time));
  if (const std::size_t frames = files_with(folder / "frames", ".vtp").size(); frames > 0)
    add(fmt::format("{} files in frames/ (open frames.pvd in ParaView)", frames));
  if (fs::exists(folder / "summary.json")) add("summary.json");
  if (!whole.empty()) out += "; whole are " + whole;
  const RunLife life = run_state(folder).life;
  if (life == RunLife::running) return out + "; the run goes on and may just be writing run.h5: try again";
  if (fs::exists(folder / "checkpoint.h5") && life != RunLife::over)
    return out + "; `epafi resume " + folder.string() + "` goes on from checkpoint.h5 and begins a new run.h5";
  return out + "; `epafi run` with the scene makes it again";
}

namespace {

constexpr std::size_t most_named = 4;

/// "a, b, c, d and 3 more tables"; more: of what, where they are too many to name.
std::string named(const std::vector<fs::path>& files, const std::string& more) {
  std::string out;
  for (std::size_t k = 0; k < std::min(most_named, files.size()); ++k)
    out += (k == 0 ? "" : ", ") + files[k].filename().string();
  return files.size() > most_named ? out + fmt::format(" and {} more{}", files.size() - most_named, more) : out;
}

/// Message for a folder with runs and tables of a sweep, chart, limits or patch.
std::string no_single_run(const fs::path& folder, const std::string& command) {
  const std::string name = folder.string();
  const std::vector<fs::path> runs = runs_in(folder);
  std::string held = named(files_with(folder, ".csv"), " tables"), open;
  if (!runs.empty())
    held += fmt::format("{}{} run{}", held.empty() ? "" : " and ", runs.size(), runs.size() > 1 ? "s" : "");
  if (!runs.empty()) open = fmt::format("; `epafi {} {}` takes one of its runs", command, runs.front().string());
  for (std::size_t k = 1; k < std::min(most_named, runs.size()); ++k)
    open += (k == 1 ? " (others: " : ", ") + runs[k].filename().string();
  if (runs.size() > 1) open += runs.size() > most_named ? " ...)" : ")";
  return "'" + name + "' is no single run: it holds " + held + "; `epafi report " + name + "` makes a page of it" +
         open;
}

/// Message for a folder that holds neither a run nor results of a study.
std::string no_run_at_all(const fs::path& folder) {
  std::error_code none;
  const std::string name = folder.string();
  if (const auto scenes = files_with(folder, ".toml"); !scenes.empty()) {
    const std::string first = scenes.front().string();
    return "no run in '" + name + "': it holds scene files (" + named(scenes, "") + "); `epafi run " + first +
           "` makes a run, `epafi view " + first + "` shows its first state";
  }
  std::vector<fs::path> all;
  for (const auto& entry : fs::directory_iterator(folder, none)) all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  const std::string held = all.empty() ? "it is empty" : "it holds " + named(all, "");
  return "no run in '" + name + "': " + held + ", and run.h5 is missing; `epafi run SCENE -o DIR` writes it";
}

}  // namespace

std::string no_run_text(const fs::path& folder, const std::string& command, const std::string& file) {
  std::error_code none;
  const std::string name = folder.string();
  if (!fs::exists(folder, none)) return "there is no folder '" + name + "'";
  const fs::path full = fs::absolute(folder, none).lexically_normal();
  const fs::path around = full.has_filename() ? full.parent_path() : full.parent_path().parent_path();
  const bool in_run = fs::exists(around / "run.h5", none);
  const std::string whole = "; `epafi " + command + " " + around.string() + "` takes it";
  if (!fs::is_directory(folder, none))
    return "'" + name + "' is a file" +
           (in_run ? " of the run in '" + around.string() + "'" + whole
                   : "; `epafi " + command + "` takes the output folder of a run");
  const bool has_run = fs::exists(folder / "run.h5", none);
  if (has_run && file != "run.h5")
    return "'" + name + "' is the folder of a run, but " + file + " is missing, which `epafi " + command +
           "` reads; run.h5 is there: `epafi view " + name + "` and `epafi report " + name + "` show the run";
  if (was_run(folder)) return "'" + name + "' is the folder of a run, but run.h5 is missing" + what_is_left(folder);
  if (in_run) return "'" + name + "' is a part of the run in '" + around.string() + "'" + whole;
  const bool is_study = !runs_in(folder).empty() || !files_with(folder, ".csv").empty();
  return is_study ? no_single_run(folder, command) : no_run_at_all(folder);
}

}  // namespace epafi
