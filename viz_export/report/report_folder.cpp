#include "viz_export/report/report_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "engine/units/error.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/files/page_target.h"
#include "viz_export/files/run_folder.h"
#include "viz_export/files/side_file.h"
#include "viz_export/files/study_mark.h"
#include "viz_export/report/html_text.h"
#include "viz_export/report/report_cases.h"
#include "viz_export/report/report_outcomes.h"
#include "viz_export/report/report_style.h"
#include "viz_export/report/report_table.h"
#include "viz_export/view/render_run.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_pictures = 12;

/// A case with a picture.
struct DrawnCase {
  std::string name;
  std::unique_ptr<ViewSource> source;
  Overview overview;
};

/// Gives cases of similar size one camera and one range of colours, for comparable pictures.
void share_overview(std::vector<DrawnCase>& cases) {
  constexpr double alike = 2.0;
  if (cases.empty()) return;
  Overview both = cases.front().overview;
  double least = both.box.diagonal();
  for (const DrawnCase& one : cases) {
    both.box.include(one.overview.box);
    least = std::min(least, one.overview.box.diagonal());
    for (const auto& [field, range] : one.overview.range) {
      auto& shared = both.range.try_emplace(field, range).first->second;
      shared = {std::min(shared[0], range[0]), std::max(shared[1], range[1])};
    }
  }
  if (both.box.diagonal() > alike * least) return;
  for (DrawnCase& one : cases) {
    if (one.overview.range != both.range) one.overview.resting.clear();  // others move
    one.overview.box = both.box;
    one.overview.range = both.range;
  }
}

/// Pictures of the final state, where cases are few and their state can be read.
std::string pictures_of(const std::vector<fs::path>& cases) {
  std::vector<DrawnCase> drawn;
  for (std::size_t k = 0; k < std::min(cases.size(), most_pictures); ++k) {
    try {
      auto source = open_run(cases[k]);
      if (source->times().empty()) continue;
      const Overview overview = look_over(*source);
      drawn.push_back({cases[k].filename().string(), std::move(source), overview});
    } catch (const FileError&) {
      continue;
    }
  }
  share_overview(drawn);
  RenderOptions options;
  options.width = 480;
  options.height = 320;
  options.title = false;
  options.letters = report_letters;
  std::string html;
  for (const DrawnCase& one : drawn) {
    RunPainter painter(*one.source, one.overview, options);
    html += "<figure><img alt='bodies' src='data:image/png;base64," +
            base64(png_of(painter.paint(one.source->times().size() - 1))) + "'/><figcaption>" + html_escaped(one.name) +
            "</figcaption></figure>";
  }
  const std::string which =
      cases.size() > most_pictures ? fmt::format("first {} of {} cases", most_pictures, cases.size()) : "cases";
  return html.empty() ? html : "<h2>How the " + which + " ended</h2><div class='grid three'>" + html + "</div>";
}

/// Title as HTML, from the JSON of a chart or limits, or the maps of a patch; "": there is none.
std::string title_of(const fs::path& folder) {
  for (const char* name : {"chart.json", "limits.json"})
    if (fs::exists(folder / name)) return html_escaped(flat_json(read_whole_file(folder / name)).text("title"));
  constexpr std::string_view open = "<title>", close = "</title>";
  for (const fs::path& map : files_with(folder, ".svg")) {
    const std::string text = read_whole_file(map).substr(0, 2000);
    const std::size_t from = text.find(open), to = text.find(close);
    if (from == text.npos || to == text.npos || to < from) continue;
    const std::string title = text.substr(from + open.size(), to - from - open.size());
    if (title != "Gnuplot") return title;
  }
  return {};
}

/// Note at the top on the unfinished part of a chart, limits or sweep.
std::string unfinished(const fs::path& folder, const std::vector<ReportCase>& cases) {
  const auto mark = read_study_mark(folder);
  if (!mark) return {};
  // runs of limits are recognised by their names; in other folders there may be runs for comparison
  const auto ended = std::count_if(cases.begin(), cases.end(), [&](const ReportCase& one) {
    return has_ended(one) && (mark->kind == "limits" || one.name.starts_with("case_"));
  });
  const std::string text = unfinished_text(*mark, static_cast<std::size_t>(ended));
  return text.empty() ? text : "<p class='warning'>" + html_escaped(text) + "</p>";
}

/// Common title of the runs; "" where it differs. Unreadable runs have none.
std::string common_title(const std::vector<ReportCase>& cases) {
  std::string title;
  for (const ReportCase& one : cases) {
    if (!title.empty() && !one.title.empty() && one.title != title) return {};
    if (title.empty()) title = one.title;
  }
  return title;
}

/// "heap: 12 cases, 3 of them without an end yet"
std::string count_text(const std::string& title, const std::vector<ReportCase>& cases) {
  const auto open = std::count_if(cases.begin(), cases.end(), [](const ReportCase& one) { return !has_ended(one); });
  const std::string rest = open > 0 ? fmt::format(", {} of them without an end yet", open) : "";
  return fmt::format("{}: {} case{}{}", title, cases.size(), cases.size() > 1 ? "s" : "", rest);
}

/// True for a table of the points of a chart or of limits.
bool is_study(const fs::path& table) { return table.stem() == "chart" || table.stem() == "limits"; }

/// True for the folder of a sweep; charts and limits have a picture of their own.
bool is_swept(const fs::path& folder) {
  const auto mark = read_study_mark(folder);
  const bool has_picture = fs::exists(folder / "chart.json") || fs::exists(folder / "limits.json");
  return !has_picture && (!mark || mark->kind == "sweep");
}

/// Charts and maps in the folder; two per row where there are several.
std::string drawings_in(const fs::path& folder) {
  const std::vector<fs::path> all = files_with(folder, ".svg");
  std::string html;
  for (const fs::path& picture : all)
    html += "<figure><img alt=\"" + html_escaped(picture.stem().string()) + "\" src='data:image/svg+xml;base64," +
            base64(read_whole_file(picture)) + "'/><figcaption>" + html_escaped(picture.stem().string()) +
            "</figcaption></figure>";
  return all.size() > 1 ? "<div class='grid'>" + html + "</div>" : html;
}

}  // namespace

bool has_tables(const fs::path& folder) {
  return fs::is_directory(folder) && (!files_with(folder, ".csv").empty() || !runs_in(folder).empty());
}

fs::path write_folder_report(const fs::path& folder, const fs::path& wanted) {
  const fs::path target = wanted.empty() ? folder / "report.html" : wanted;
  require_page_target(target);
  const std::string title = fs::absolute(folder).lexically_normal().filename().string();
  const std::vector<fs::path> folders = runs_in(folder);
  std::vector<ReportCase> cases;
  for (const fs::path& one : folders) cases.push_back(read_case(one));
  std::string scene = title_of(folder);
  if (scene.empty()) scene = html_escaped(common_title(cases));
  std::string html = "<h1>" + (scene.empty() ? html_escaped(title) : scene) + "</h1>";
  if (!cases.empty()) html += "<p class='sub'>" + html_escaped(count_text(title, cases)) + "</p>";
  const fs::path results = folder / "patch.csv";  // of `epafi patch --maps`: what the maps belong to
  html += unfinished(folder, cases) + warnings_html(cases);
  html += (fs::exists(results) ? csv_html(results) : "") + drawings_in(folder);
  for (const fs::path& table : files_with(folder, ".csv"))
    if (is_study(table)) html += csv_html(table);
  if (!cases.empty())
    html += cases_html(cases) + (is_swept(folder) ? outcomes_html(cases, target) : "") + pictures_of(folders);
  for (const fs::path& table : files_with(folder, ".csv")) {
    if (table != results && !is_study(table)) html += csv_html(table);
  }
  write_whole_file(target, {"<!doctype html><html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
                            "content='width=device-width'><title>",
                            html_escaped(title), "</title>", report_style, "</head><body>", html, "</body></html>\n"});
  return target;
}

}  // namespace epafi
