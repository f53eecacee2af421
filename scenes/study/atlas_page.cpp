#include "scenes/study/atlas_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/units/registry.h"
#include "scenes/study/atlas.h"

namespace epafi {
namespace {

constexpr const char* first_mark = "<!-- measured: written by the command below -->\n";
constexpr const char* last_mark = "<!-- end of what was measured -->\n";

/// "contact.nonsmooth.iterations=5; run.time_step=1e-3" as "iterations=5; time_step=1e-3": the page has the whole
/// names.
std::string short_settings(const StudyMethod& method) {
  std::string out;
  for (const std::string& o : method.overrides) {
    const std::size_t equal = o.find('='), dot = o.rfind('.', equal);
    std::string part = o.substr(dot == std::string::npos ? 0 : dot + 1);
    std::erase(part, '"');
    if (part.substr(part.find('=') + 1) != method.name) out += (out.empty() ? "" : "; ") + part;
  }
  return out;
}

std::string head(const char* command, const std::string& stem, const std::string& title,
                 const std::vector<std::string>& pictures) {
  std::string out =
      fmt::format("`epafi {} scenes/library/studies/{}.toml` ([numbers]({}.csv))\n\n", command, stem, stem);
  for (const std::string& p : pictures) out += fmt::format("![{}]({})\n", title, p);
  return out + "\n";
}

std::string note_of(const Chart& chart, std::size_t k) {
  const ChartPoint& p = chart.points[k];
  std::string note = p.good() ? (p.pareto ? "front" : "") : p.status;
  if (chart.recommended == k) note += ", recommended";
  return note;
}

/// Above this number of points a page shows those that decide; the CSV file holds all.
constexpr std::size_t most_rows = 60;

/// The points of a page: all, or those on the front, the recommended one and the most accurate one of each method. A
/// method without an answer has its first point there, which says why.
std::vector<std::size_t> shown_points(const Chart& chart) {
  std::vector<std::size_t> shown;
  const bool all = chart.points.size() <= most_rows;
  const auto error = [](const ChartPoint& p) { return p.good() && !std::isnan(p.error) ? p.error : infinity; };
  for (std::size_t k = 0; k < chart.points.size(); ++k) {
    const ChartPoint& p = chart.points[k];
    bool is_best = true;
    for (std::size_t other = 0; other < chart.points.size(); ++other) {
      const ChartPoint& q = chart.points[other];
      if (q.method.name != p.method.name) continue;
      if (error(q) < error(p) || (error(q) == error(p) && other < k)) is_best = false;
    }
    if (all || p.pareto || chart.recommended == k || is_best) shown.push_back(k);
  }
  return shown;
}

std::string or_dash(const std::optional<double>& v) { return v ? fmt::format("{:.4g}", *v) : "-"; }

}  // namespace

std::string measured_text(const Chart& chart, const std::string& stem, const std::vector<std::string>& pictures) {
  std::string out = head("chart", stem, chart.study.title, pictures);
  if (chart.points.size() > most_rows)
    out += fmt::format("The front and the most accurate row of each method; the numbers hold all {} rows.\n\n",
                       chart.points.size());
  const std::size_t further = chart.study.more_errors.size();
  out += "| method | settings | time | spread | " + chart.study.error.axis_label();
  for (const ErrorSpec& e : chart.study.more_errors) out += " | " + e.axis_label();
  out += " | |\n|---|---|---|---|---|---|";
  for (std::size_t k = 0; k < further; ++k) out += "---|";
  const std::vector<std::size_t> shown = shown_points(chart);
  for (std::size_t k : shown) {
    const ChartPoint& p = chart.points[k];
    out += fmt::format("\n| {} | {} | {:.3g} | {:.1g} | {}", p.method.name, short_settings(p.method), p.time,
                       p.time_spread, p.good() && !std::isnan(p.error) ? fmt::format("{:.3g}", p.error) : "");
    for (std::size_t e = 0; e < further; ++e)
      out += p.good() && e < p.more_errors.size() && !std::isnan(p.more_errors[e])
                 ? fmt::format(" | {:.3g}", p.more_errors[e])
                 : " | ";
    out += " | " + note_of(chart, k) + " |";
  }
  return out + "\n\nTime: " + chart.time_label + ".\n```text\n" + chart_verdict(chart) + "```\n";
}

std::string measured_text(const LimitMap& map, const std::string& stem, const std::vector<std::string>& pictures) {
  std::string out = head("limits", stem, map.study.title, pictures);
  const bool two = map.study.parameters.size() == 2, theory = !map.study.theory.empty();
  const std::string& what = map.study.parameters.back().label;
  out += "| method | " + (two ? map.study.parameters.front().label + " | " : std::string{}) + what +
         ": good | failing | kind of failure |" +
         (theory ? " " + (map.study.theory_label.empty() ? "theory" : map.study.theory_label) + " |" : "") +
         "\n|---|---|---|---|" + (two ? "---|" : "") + (theory ? "---|" : "") + "\n";
  for (const Limit& l : map.limits) {
    out += "| " + map.study.methods[l.method].name + " | ";
    if (two) out += or_dash(l.at) + " | ";
    out += or_dash(l.last_good) + " | " + or_dash(l.first_failing) + " | " + l.kind + " |";
    if (theory) out += " " + or_dash(l.theory) + " |";
    out += "\n";
  }
  if (!map.whole) out += "\nThe budget ended this map before its last cases.\n";
  return out;
}

std::string page_with(const std::string& page, const std::string& title, const std::string& measured) {
  const std::string block = first_mark + measured + last_mark;
  const std::size_t from = page.find(first_mark), to = page.find(last_mark);
  if (page.empty()) return "# " + title + "\n\n" + block;
  if (from == std::string::npos || to == std::string::npos || to < from) return page + "\n" + block;
  return page.substr(0, from) + block + page.substr(to + std::string_view(last_mark).size());
}

std::string atlas_index(const std::filesystem::path& studies) {
  std::string out =
      "# Atlas: what accuracy costs, and where methods stop working\n\n"
      "`epafi chart --all` and `epafi limits --all` draw all charts and maps again (`--budget 30m`). They write the "
      "tables of the pages and this list,\nand print the rows that differ from the stored tables by more than their "
      "spread. Times are processor seconds on one core of the machine that drew them:\ncompare them within a picture. "
      "Errors and state hashes have the same bits on every run.\n";
  for (const bool charts : {true, false}) {
    std::vector<Study> all = studies_in(studies, charts);
    std::sort(all.begin(), all.end(), [](const Study& a, const Study& b) { return a.file < b.file; });
    out += charts ? "\n## Speed against accuracy: `epafi chart`\n\n" : "\n## Where methods fail: `epafi limits`\n\n";
    for (const Study& s : all) {
      const std::string stem = std::filesystem::path(s.file).stem().string();
      out += fmt::format("* [{}]({}.md)\n", s.title.empty() ? stem : s.title, stem);
    }
  }
  return out;
}

}  // namespace epafi
