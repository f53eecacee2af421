#include "viz_export/report_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "engine/error.h"
#include "viz_export/html_text.h"
#include "viz_export/json_reader.h"
#include "viz_export/report_style.h"
#include "viz_export/side_file.h"
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

std::string row_of(const std::vector<std::string>& cells, const char* tag) {
  std::string out = "<tr>";
  for (const std::string& cell : cells) out += fmt::format("<{0}>{1}</{0}>", tag, html_escaped(cell));
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

/// What differs between cases comes first: a column for each number that all have.
std::string table_of(const std::vector<fs::path>& cases) {
  const std::vector<std::pair<std::string, std::string>> columns{{"bodies", "bodies"},
                                                                 {"simulated_time", "time [s]"},
                                                                 {"wall_time", "wall time [s]"},
                                                                 {"ns_per_body_step", "ns per body and step"},
                                                                 {"energy.relative_error", "energy error"},
                                                                 {"overlap.max_relative", "overlap over radius"},
                                                                 {"residual.max", "residual"}};
  std::set<std::string> measured;
  std::vector<FlatJson> all;
  for (const fs::path& one : cases) {
    all.push_back(read_json(one / "summary.json"));
    for (const auto& [name, value] : all.back().numbers)
      if (name.starts_with("measures.") && name.ends_with(".last")) measured.insert(name);
  }
  std::vector<std::string> head{"case", "status"};
  for (const auto& [name, label] : columns) head.push_back(label);
  for (const std::string& name : measured) head.push_back(name.substr(9, name.size() - 14));
  std::string html = "<h2>Cases</h2><div style='overflow-x:auto'><table>" + row_of(head, "th");
  const auto cell = [](const FlatJson& json, const std::string& name) {
    const auto value = json.number(name);
    return value ? fmt::format("{:.5g}", *value) : std::string("-");
  };
  for (std::size_t k = 0; k < cases.size(); ++k) {
    std::vector<std::string> row{cases[k].filename().string(), all[k].text("status")};
    for (const auto& [name, label] : columns) row.push_back(cell(all[k], name));
    for (const std::string& name : measured) row.push_back(cell(all[k], name));
    html += row_of(row, "td");
  }
  return html + "</table></div>";
}

/// How each case ended, of a few; those without a state that can be read have none.
std::string pictures_of(const std::vector<fs::path>& cases) {
  std::string html;
  for (std::size_t k = 0; k < std::min(cases.size(), most_pictures); ++k) {
    try {
      const auto source = open_run(cases[k]);
      if (source->times().empty()) continue;
      RenderOptions options;
      options.width = 480;
      options.height = 320;
      RunPainter painter(*source, look_over(*source), options);
      html += "<figure><img alt='bodies' src='data:image/png;base64," +
              base64(png_of(painter.paint(source->times().size() - 1))) + "'/><figcaption>" +
              html_escaped(cases[k].filename().string()) + "</figcaption></figure>";
    } catch (const FileError&) {
      continue;
    }
  }
  return html.empty() ? html : "<h2>How the cases ended</h2><div class='grid three'>" + html + "</div>";
}

}  // namespace

bool has_tables(const fs::path& folder) {
  return fs::is_directory(folder) && (!files_with(folder, ".csv").empty() || !cases_in(folder).empty());
}

fs::path write_folder_report(const fs::path& folder, const fs::path& wanted) {
  const std::string title = fs::absolute(folder).lexically_normal().filename().string();
  std::string html = "<h1>" + html_escaped(title) + "</h1>";
  for (const fs::path& picture : files_with(folder, ".svg"))
    html += "<figure><img alt='" + html_escaped(picture.stem().string()) + "' src='data:image/svg+xml;base64," +
            base64(read_whole_file(picture)) + "'/><figcaption>" + html_escaped(picture.stem().string()) +
            "</figcaption></figure>";
  const std::vector<fs::path> cases = cases_in(folder);
  if (!cases.empty()) html += table_of(cases) + pictures_of(cases);
  for (const fs::path& table : files_with(folder, ".csv")) html += table_of(table);
  const fs::path target = wanted.empty() ? folder / "report.html" : wanted;
  write_whole_file(target, {"<!doctype html><html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
                            "content='width=device-width'><title>",
                            html_escaped(title), "</title>", report_style, "</head><body>", html, "</body></html>\n"});
  return target;
}

}  // namespace epafi
