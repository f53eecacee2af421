#include "viz_export/files/run_folder.h"

#include <fmt/format.h>

#include <algorithm>

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

std::string no_run_text(const fs::path& folder, const std::string& command) {
  std::error_code none;
  const std::string name = folder.string();
  if (!fs::exists(folder, none)) return "there is no folder '" + name + "'";
  if (!fs::is_directory(folder, none))
    return "'" + name + "' is a file; `epafi " + command + "` takes the output folder of a run";
  constexpr std::size_t most_named = 4;
  const std::vector<fs::path> runs = runs_in(folder), tables = files_with(folder, ".csv");
  if (runs.empty() && tables.empty()) return "no run in '" + name + "': run.h5 is missing; `epafi run` writes it";
  std::string held, open;
  for (std::size_t k = 0; k < std::min(most_named, tables.size()); ++k)
    held += (k == 0 ? "" : ", ") + tables[k].filename().string();
  if (tables.size() > most_named) held += fmt::format(" and {} more tables", tables.size() - most_named);
  if (!runs.empty())
    held += fmt::format("{}{} run{}", held.empty() ? "" : " and ", runs.size(), runs.size() > 1 ? "s" : "");
  if (!runs.empty()) open = fmt::format("; `epafi {} {}` takes one of its runs", command, runs.front().string());
  for (std::size_t k = 1; k < std::min(most_named, runs.size()); ++k)
    open += (k == 1 ? " (others: " : ", ") + runs[k].filename().string();
  if (runs.size() > 1) open += runs.size() > most_named ? " ...)" : ")";
  return "'" + name + "' is no single run: it holds " + held + "; `epafi report " + name + "` makes a page of it" +
         open;
}

}  // namespace epafi
