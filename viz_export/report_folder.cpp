#include "viz_export/report_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "engine/error.h"
#include "viz_export/html_text.h"
#include "viz_export/json_reader.h"
#include "viz_export/measure_units.h"
#include "viz_export/report_style.h"
#include "viz_export/side_file.h"
#include "viz_export/stored_run.h"
#include "viz_export/view/render_run.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_rows = 500;  // of a table; the CSV has them all
constexpr std::size_t open_rows = 60;   // longer tables are folded up
constexpr std::size_t most_pictures = 12;

std::vector<fs::path> files_with(const fs::path& folder, const std::string& ending) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().extension() == ending) out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

/// Folders of finished cases, by name.
std::vector<fs::path> cases_in(const fs::path& folder) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && fs::exists(entry.path() / "summary.json")) out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

/// Fields of a line; quotes as in RFC 4180, without line breaks inside.
std::vector<std::string> csv_fields(const std::string& line) {
  std::vector<std::string> out(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      out.emplace_back();
    else if (c != '\r')
      out.back() += c;
  }
  return out;
}

bool is_number(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  return !text.empty() && std::from_chars(text.data(), end, value).ptr == end;
}

std::string row_of(const std::vector<std::string>& cells, const char* tag) {
  std::string out = "<tr>";
  for (const std::string& cell : cells)
    out += fmt::format("<{0}{2}>{1}</{0}>", tag, html_escaped(cell), is_number(cell) ? " class='n'" : "");
  return out + "</tr>";
}

std::string table_of(const fs::path& path) {
  std::istringstream in(read_whole_file(path));
  std::string html = "<div style='overflow-x:auto'><table>";
  std::size_t rows = 0;
  for (std::string line; std::getline(in, line); ++rows) {
    if (line.empty() || line.front() == '#') continue;
    if (rows <= most_rows) html += row_of(csv_fields(line), rows == 0 ? "th" : "td");
  }
  html += "</table></div>";
  if (rows > most_rows) html += fmt::format("<p class='sub'>{} of {} rows</p>", most_rows, rows - 1);
  if (rows > open_rows) html = fmt::format("<details><summary>{} rows</summary>{}</details>", rows - 1, html);
  return "<h2>" + html_escaped(path.filename().string()) + "</h2>" + html;
}

/// A finished case.
struct Case {
  std::string name;
  FlatJson summary;
  std::map<std::string, std::string> set{};       ///< overrides by key
  std::map<std::string, MeasureUnit> measured{};  ///< "heap.z" and what it is
  std::string title{};
};

/// Damaged or missing run files leave only the summary.
Case read_case(const fs::path& folder) {
  Case out{folder.filename().string(), read_json(folder / "summary.json")};
  try {
    const StoredRun run(folder / "run.h5");
    out.title = run.title();
    std::istringstream lines(run.overrides());
    for (std::string line; std::getline(lines, line);)
      if (const std::size_t equal = line.find('='); equal != line.npos)
        out.set[line.substr(0, equal)] = line.substr(equal + 1);
    for (const StoredMeasure& m : run.measures())
      for (const std::string& c : m.components) out.measured[m.name + "." + c] = measure_unit(m.kind, c);
  } catch (const FileError&) {
  }
  return out;
}

/// A column of the table of cases: empty cells where a case has nothing to say.
struct CaseColumn {
  std::string head;
  std::vector<std::string> cells{};
  bool says_something() const {
    return std::any_of(cells.begin(), cells.end(), [](const std::string& c) { return !c.empty(); });
  }
  bool differs() const { return std::adjacent_find(cells.begin(), cells.end(), std::not_equal_to<>()) != cells.end(); }
};

/// The overrides that are not the same in all cases; those of a single case all.
std::vector<CaseColumn> override_columns(const std::vector<Case>& cases) {
  std::set<std::string> keys;
  for (const Case& one : cases)
    for (const auto& [key, value] : one.set) keys.insert(key);
  std::vector<CaseColumn> out;
  for (const std::string& key : keys) {
    CaseColumn column{key};
    for (const Case& one : cases) column.cells.push_back(one.set.contains(key) ? one.set.at(key) : "");
    if (column.differs() || cases.size() == 1) out.push_back(std::move(column));
  }
  return out;
}

CaseColumn summary_column(const std::vector<Case>& cases, const std::string& name, const std::string& head) {
  CaseColumn column{head};
  for (const Case& one : cases) {
    const auto value = one.summary.number(name);
    column.cells.push_back(value ? fmt::format("{:.5g}", *value) : "");
  }
  return column;
}

std::vector<CaseColumn> measured_columns(const std::vector<Case>& cases) {
  std::map<std::string, MeasureUnit> measured;
  for (const Case& one : cases) {
    measured.insert(one.measured.begin(), one.measured.end());
    for (const auto& [name, value] : one.summary.numbers)
      if (name.starts_with("measures.") && name.ends_with(".last"))
        measured.insert({name.substr(9, name.size() - 14), {}});
  }
  std::vector<CaseColumn> out;
  for (const auto& [name, unit] : measured) {
    const std::string head = unit.unit.empty() ? name : name + " [" + unit.unit + "]";
    out.push_back(summary_column(cases, "measures." + name + ".last", head));
  }
  return out;
}

/// What differs between cases comes first, then what is known of each, then what was measured at the end.
std::string table_of(const std::vector<Case>& cases) {
  CaseColumn name{"case"}, status{"status"};
  for (const Case& one : cases) {
    name.cells.push_back(one.name);
    status.cells.push_back(one.summary.text("status"));
  }
  std::vector<CaseColumn> columns{name, status};
  const auto add = [&](std::vector<CaseColumn> more) {
    for (CaseColumn& column : more)
      if (column.says_something()) columns.push_back(std::move(column));
  };
  add(override_columns(cases));
  for (const auto& [key, head] : {std::pair{"bodies", "bodies"},
                                  {"simulated_time", "time [s]"},
                                  {"wall_time", "wall time [s]"},
                                  {"ns_per_body_step", "ns per body and step"},
                                  {"energy.relative_error", "energy error"},
                                  {"overlap.max_relative", "overlap over radius"},
                                  {"residual.max", "residual"}})
    add({summary_column(cases, key, head)});
  add(measured_columns(cases));
  std::string html = "<h2>Cases</h2><div style='overflow-x:auto'><table><tr>";
  for (const CaseColumn& column : columns)
    html +=
        fmt::format("<th{}>{}</th>", is_number(column.cells.front()) ? " class='n'" : "", html_escaped(column.head));
  html += "</tr>";
  for (std::size_t k = 0; k < cases.size(); ++k) {
    std::vector<std::string> row;
    for (const CaseColumn& column : columns) row.push_back(column.cells[k].empty() ? "-" : column.cells[k]);
    html += row_of(row, "td");
  }
  return html + "</table></div>";
}

/// What went wrong, of ten cases at most.
std::string warnings_of(const std::vector<Case>& cases) {
  constexpr std::size_t most = 10;
  std::vector<std::string> all;
  for (const Case& one : cases)
    for (const auto& [name, text] : one.summary.texts)
      if (name.starts_with("warnings.") || (name == "failure" && !text.empty())) all.push_back(one.name + ": " + text);
  std::string html;
  for (std::size_t k = 0; k < std::min(most, all.size()); ++k)
    html += "<p class='warning'>" + html_escaped(all[k]) + "</p>";
  if (all.size() > most) html += fmt::format("<p class='warning'>and {} more warnings</p>", all.size() - most);
  return html;
}

/// A case that is drawn.
struct DrawnCase {
  std::string name;
  std::unique_ptr<ViewSource> source;
  Overview overview;
};

/// Cases of nearly one size get one camera and one range of colours: pictures can then be compared.
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
    one.overview.box = both.box;
    one.overview.range = both.range;
  }
}

/// How each case ended, of a few; those without a state that can be read have none.
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
  std::string html;
  for (const DrawnCase& one : drawn) {
    RunPainter painter(*one.source, one.overview, options);
    html += "<figure><img alt='bodies' src='data:image/png;base64," +
            base64(png_of(painter.paint(one.source->times().size() - 1))) + "'/><figcaption>" + html_escaped(one.name) +
            "</figcaption></figure>";
  }
  return html.empty() ? html : "<h2>How the cases ended</h2><div class='grid three'>" + html + "</div>";
}

/// Charts and maps that lie in the folder; two in a row where there are several.
std::string drawings_in(const fs::path& folder) {
  const std::vector<fs::path> all = files_with(folder, ".svg");
  std::string html;
  for (const fs::path& picture : all)
    html += "<figure><img alt='" + html_escaped(picture.stem().string()) + "' src='data:image/svg+xml;base64," +
            base64(read_whole_file(picture)) + "'/><figcaption>" + html_escaped(picture.stem().string()) +
            "</figcaption></figure>";
  return all.size() > 1 ? "<div class='grid'>" + html + "</div>" : html;
}

}  // namespace

bool has_tables(const fs::path& folder) {
  return fs::is_directory(folder) && (!files_with(folder, ".csv").empty() || !cases_in(folder).empty());
}

fs::path write_folder_report(const fs::path& folder, const fs::path& wanted) {
  const std::string title = fs::absolute(folder).lexically_normal().filename().string();
  const std::vector<fs::path> folders = cases_in(folder);
  std::vector<Case> cases;
  for (const fs::path& one : folders) cases.push_back(read_case(one));
  const std::string scene = cases.empty() ? "" : cases.front().title;
  std::string html = "<h1>" + html_escaped(scene.empty() ? title : scene) + "</h1>";
  if (!cases.empty())
    html +=
        fmt::format("<p class='sub'>{}: {} case{}</p>", html_escaped(title), cases.size(), cases.size() > 1 ? "s" : "");
  html += warnings_of(cases) + drawings_in(folder);
  if (!cases.empty()) html += table_of(cases) + pictures_of(folders);
  for (const fs::path& table : files_with(folder, ".csv")) html += table_of(table);
  const fs::path target = wanted.empty() ? folder / "report.html" : wanted;
  write_whole_file(target, {"<!doctype html><html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
                            "content='width=device-width'><title>",
                            html_escaped(title), "</title>", report_style, "</head><body>", html, "</body></html>\n"});
  return target;
}

}  // namespace epafi
