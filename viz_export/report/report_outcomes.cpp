#include "viz_export/report/report_outcomes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "viz_export/files/side_file.h"
#include "viz_export/report/charts.h"
#include "viz_export/report/html_text.h"
#include "viz_export/report/parts_folder.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_plots = 6, most_lines = 8;

double number_of(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  return std::from_chars(text.data(), end, value).ptr == end && !text.empty()
             ? value
             : std::numeric_limits<double>::quiet_NaN();
}

std::string value_of(const ReportCase& one, const std::string& key) {
  const auto found = one.set.find(key);
  return found == one.set.end() ? "" : found->second;
}

/// Overrides that differ between cases, with their number of values.
std::map<std::string, std::size_t> swept_keys(const std::vector<ReportCase>& cases) {
  std::set<std::string> keys;
  for (const ReportCase& one : cases)
    for (const auto& [key, value] : one.set) keys.insert(key);
  std::map<std::string, std::size_t> out;
  for (const std::string& key : keys) {
    std::set<std::string> values;
    for (const ReportCase& one : cases) values.insert(value_of(one, key));
    if (values.size() > 1) out[key] = values.size();
  }
  return out;
}

/// The numeric override with most values; a seed only where nothing else is swept.
std::string abscissa_of(const std::vector<ReportCase>& cases, const std::map<std::string, std::size_t>& keys) {
  std::string best;
  std::size_t most = 0;
  for (const auto& [key, values] : keys) {
    const bool numeric = std::ranges::all_of(
        cases, [&, name = key](const ReportCase& one) { return std::isfinite(number_of(value_of(one, name))); });
    const std::size_t weight = key.ends_with("seed") ? 1 : values;
    if (!numeric || weight <= most) continue;
    most = weight;
    best = key;
  }
  return best;
}

/// A value of the summary, and the label of its axis.
struct Outcome {
  std::string key, label;
};

std::vector<Outcome> outcomes_of(const std::vector<ReportCase>& cases) {
  std::map<std::string, MeasureUnit> measured;
  for (const ReportCase& one : cases) measured.insert(one.measured.begin(), one.measured.end());
  std::vector<Outcome> all;
  for (const auto& [name, unit] : measured)
    all.push_back(
        {"measures." + name + ".last", name + " at the end" + (unit.unit.empty() ? "" : " [" + unit.unit + "]")});
  all.push_back({"energy.relative_error", "energy error"});
  all.push_back({"overlap.max_relative", "deepest overlap over radius"});
  all.push_back({"residual.max", "residual, worst step"});
  std::vector<Outcome> out;
  for (Outcome& one : all) {
    std::set<double> values;
    for (const ReportCase& c : cases)
      if (const auto value = c.summary.number(one.key)) values.insert(*value);
    if (values.size() > 1 && out.size() < most_plots) out.push_back(std::move(one));
  }
  return out;
}

/// The other overrides of a case, as "params.mu=0.4, run.scheme=euler".
std::string others_of(const ReportCase& one, const std::map<std::string, std::size_t>& keys, const std::string& at) {
  std::string out;
  for (const auto& [key, values] : keys)
    if (key != at) out += (out.empty() ? "" : ", ") + key + "=" + value_of(one, key);
  return out;
}

ScatterPlot plot_of(const std::vector<ReportCase>& cases, const std::map<std::string, std::size_t>& keys,
                    const std::string& at, const Outcome& outcome) {
  std::map<std::string, std::vector<PlotPoint>> lines;
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const ReportCase& one : cases) {
    const double x = number_of(value_of(one, at));
    const auto y = one.summary.number(outcome.key);
    if (!y || !std::isfinite(*y)) continue;
    lines[others_of(one, keys, at)].push_back({x, *y});
    least = std::min(least, x);
    most = std::max(most, x);
  }
  constexpr double decades = 30;
  ScatterPlot plot;
  plot.x_label = at;
  plot.y_label = outcome.label;
  plot.size = "620,420";
  plot.log_x = least > 0 && most > decades * least;
  plot.log_y = false;
  const bool few = lines.size() <= most_lines;
  plot.joined = few;
  for (auto& [label, points] : lines) {
    std::sort(points.begin(), points.end());
    if (few || plot.lines.empty()) plot.lines.push_back({few ? label : "cases", {}, {}});
    auto& all = plot.lines.back().points;
    all.insert(all.end(), points.begin(), points.end());
  }
  return plot;
}

}  // namespace

std::string outcomes_html(const std::vector<ReportCase>& all, const fs::path& target) {
  std::vector<ReportCase> cases;
  std::string left_out;
  for (const ReportCase& one : all) {
    if (has_ended(one))
      cases.push_back(one);
    else
      left_out += (left_out.empty() ? "" : ", ") + one.name;
  }
  const auto keys = swept_keys(cases);
  const std::string at = abscissa_of(cases, keys);
  const std::vector<Outcome> outcomes = outcomes_of(cases);
  if (at.empty() || outcomes.empty()) return {};
  const PartsFolder parts(target);
  std::string html;
  for (std::size_t k = 0; k < outcomes.size(); ++k) {
    const fs::path path = parts.path() / fmt::format("outcome_{}", k);
    if (!draw(plot_of(cases, keys, at, outcomes[k]), path))
      return "<p class='no'>gnuplot is not installed: the plots of the outcomes are missing.</p>";
    html += "<figure><img alt=\"" + html_escaped(outcomes[k].label) + "\" src='data:image/svg+xml;base64," +
            base64(read_whole_file(fs::path(path) += ".svg")) + "'/><figcaption>" +
            html_escaped(outcomes[k].label + " over " + at) + "</figcaption></figure>";
  }
  const std::string without =
      left_out.empty() ? "" : "<p class='sub'>Without the cases that have no end: " + html_escaped(left_out) + "</p>";
  return "<h2>What came out</h2>" + without + "<div class='grid'>" + html + "</div>";
}

}  // namespace epafi
