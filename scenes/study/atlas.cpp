#include "scenes/study/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <sstream>

#include "scenes/reader/text_cells.h"
#include "scenes/study/atlas_page.h"
#include "scenes/study/chart.h"
#include "scenes/study/limits.h"
#include "viz_export/files/side_file.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;
using Row = std::map<std::string, std::string>;

std::vector<Row> rows_of(const std::string& csv) {
  std::vector<Row> rows;
  std::vector<TextCell> header;
  std::istringstream in(csv);
  std::string line;
  for (int line_number = 0; next_text_line(in, line, line_number);) {
    const auto cells = cells_of_line(line);
    if (header.empty()) {
      header = cells;
      continue;
    }
    Row row;
    for (std::size_t k = 0; k < std::min(header.size(), cells.size()); ++k) row[header[k].text] = cells[k].text;
    rows.push_back(std::move(row));
  }
  return rows;
}

double number(const Row& row, const std::string& column) {
  const auto at = row.find(column);
  return at == row.end() || at->second.empty() ? NAN : std::strtod(at->second.c_str(), nullptr);
}
std::string text(const Row& row, const std::string& column) {
  const auto at = row.find(column);
  return at == row.end() ? std::string{} : at->second;
}

std::string name_of(const Row& row) {
  std::string name = text(row, "method") + " [" + text(row, "settings") + "]";
  for (const char* column : {"value_2", "value"})
    if (!text(row, column).empty()) name += " at " + text(row, column);
  return name;
}

void compare(const Row& old, const Row& now, std::vector<std::string>& out) {
  const auto say = [&](const std::string& what) { out.push_back(name_of(now) + ": " + what); };
  for (const char* column : {"status", "kind_of_failure"})
    if (text(old, column) != text(now, column))
      say(fmt::format("{} '{}', stored '{}'", column, text(now, column), text(old, column)));
  if (text(old, "status") != "completed" || text(now, "status") != "completed") return;
  const double before = number(old, "error"), error = number(now, "error");
  const double spread = std::max({number(old, "error_spread"), number(now, "error_spread"), 1e-9 * std::abs(before)});
  if (std::abs(error - before) > spread)
    say(fmt::format("{}: error {:.4g}, stored {:.4g}", error < before ? "better" : "worse", error, before));
  const double time_before = number(old, "time"), time = number(now, "time");
  const double noise = std::max(number(old, "time_spread") + number(now, "time_spread"), 0.2 * time_before);
  if (std::abs(time - time_before) > noise)
    say(fmt::format("{}: time {:.4g}, stored {:.4g}", time < time_before ? "quicker" : "slower", time, time_before));
}

std::size_t cases_of(const Study& s) {
  std::size_t cases = std::max<std::size_t>(1, s.methods.size());
  for (const auto& p : s.parameters) cases *= p.bisect ? 8 : std::max<std::size_t>(1, p.values.size());
  return cases * (s.parameters.empty() ? static_cast<std::size_t>(s.repeats) : 1);
}

/// Table, pictures and page of one study into the atlas; rows that moved are reported. command: chart or limits.
template <class Result>
void store(const AtlasOrder& order, const std::string& stem, const std::string& command, const std::string& csv,
           const Result& result, const std::function<void(const std::string&)>& say) {
  const fs::path file = order.atlas / (stem + ".csv"), page = order.atlas / (stem + ".md");
  if (fs::exists(file)) {
    const auto moved = moved_rows(read_whole_file(file), csv);
    for (const auto& line : moved) say("  " + line);
    say(fmt::format("{}: {} rows moved against the stored table", stem, moved.size()));
  } else {
    say(stem + ": new in the atlas");
  }
  write_whole_file(file, {csv});
  std::vector<std::string> pictures;
  for (const auto& entry : fs::directory_iterator(order.work / stem)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".svg") continue;
    pictures.push_back(stem + name.substr(command.size()));
    fs::copy_file(entry.path(), order.atlas / pictures.back(), fs::copy_options::overwrite_existing);
  }
  std::sort(pictures.begin(), pictures.end(),
            [](const std::string& a, const std::string& b) { return std::pair(a.size(), a) < std::pair(b.size(), b); });
  const Study& study = result.study;
  write_whole_file(page, {page_with(fs::exists(page) ? read_whole_file(page) : "",
                                    study.title.empty() ? stem : study.title, measured_text(result, stem, pictures))});
}

}  // namespace

std::vector<Study> studies_in(const fs::path& folder, bool charts) {
  std::vector<Study> all;
  if (!fs::is_directory(folder))
    throw FileError("the folder '" + folder.string() + "' does not exist; --studies names another");
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".toml") continue;
    Study s = read_study(entry.path().string(), {});
    if (charts == s.parameters.empty()) all.push_back(std::move(s));
  }
  std::sort(all.begin(), all.end(), [](const Study& a, const Study& b) {
    return std::pair(cases_of(a), a.file) < std::pair(cases_of(b), b.file);
  });
  return all;
}

std::vector<std::string> moved_rows(const std::string& stored_csv, const std::string& new_csv) {
  std::map<std::string, Row> stored;
  for (auto& row : rows_of(stored_csv)) stored[name_of(row)] = row;
  std::vector<std::string> out;
  for (const auto& row : rows_of(new_csv)) {
    const auto at = stored.find(name_of(row));
    if (at == stored.end())
      out.push_back(name_of(row) + ": new");
    else
      compare(at->second, row, out);
  }
  return out;
}

bool draw_atlas(const AtlasOrder& order, bool charts, const std::function<void(const std::string&)>& say) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  const auto left = [&] { return order.budget - std::chrono::duration<double>(Clock::now() - begin).count(); };
  std::vector<Study> studies = studies_in(order.studies, charts);
  std::erase_if(studies, [&](const Study& s) {
    const std::string stem = fs::path(s.file).stem().string();
    return !order.only.empty() && std::find(order.only.begin(), order.only.end(), stem) == order.only.end();
  });
  std::size_t waiting = studies.size();
  fs::create_directories(order.atlas);
  bool whole = true;
  for (Study& s : studies) {
    const std::string stem = fs::path(s.file).stem().string();
    s.program = order.program;
    s.budget = 2.0 * left() / static_cast<double>(waiting--);  // most need far less than their part
    if (left() < 1.0) {
      say(stem + ": left out, the budget is spent");
      whole = false;
      continue;
    }
    const fs::path work = order.work / stem;
    fs::create_directories(work);
    for (const auto& entry : fs::directory_iterator(work))  // pictures of an earlier state of the study
      if (entry.path().extension() == ".svg") fs::remove(entry.path());
    say(fmt::format("{}: {} cases", stem, cases_of(s)));
    if (charts) {
      const Chart chart = chart_of(s, work, say);
      draw_chart(chart, work);
      store(order, stem, "chart", chart_csv(chart), chart, say);
    } else {
      const LimitMap map = run_limits(s, work, order.jobs, say);
      draw_limits(map, work);
      whole = whole && map.whole;
      store(order, stem, "limits", limits_csv(map), map, say);
    }
  }
  write_whole_file(order.atlas / "README.md", {atlas_index(order.studies)});
  return whole;
}

}  // namespace epafi
