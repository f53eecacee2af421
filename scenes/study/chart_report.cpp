#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/study/chart.h"
#include "viz_export/files/json_writer.h"
#include "viz_export/report/charts.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

std::string number(const std::optional<double>& v) { return v ? fmt::format("{}", *v) : ""; }

/// Nothing where a method has no such error.
std::string error_number(const ChartPoint& p, double error) {
  return p.good() && !std::isnan(error) ? fmt::format("{}", error) : "";
}

std::string name_of(const ErrorSpec& e) { return e.name + (e.component.empty() ? "" : "." + e.component); }

}  // namespace

std::string chart_csv(const Chart& chart) {
  std::string out =
      "method,settings,time,error,error_spread,status,residual,energy_error,overlap_relative,state_hash,pareto,time_"
      "spread,ns_per_body_step,accurate";
  for (const ErrorSpec& e : chart.study.more_errors) out += ",error:" + name_of(e);
  out += "\n";
  for (const auto& p : chart.points) {
    out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}", csv_text(p.method.name),
                       csv_text(p.method.settings()), p.time, error_number(p, p.error), p.error_spread, p.status,
                       number(p.residual), number(p.energy_error), number(p.overlap_relative), p.state_hash,
                       p.pareto ? 1 : 0, p.time_spread, p.ns_per_body_step, p.accurate ? 1 : 0);
    for (std::size_t k = 0; k < chart.study.more_errors.size(); ++k)
      out += "," + (k < p.more_errors.size() ? error_number(p, p.more_errors[k]) : "");
    out += "\n";
  }
  return out;
}

std::string chart_json(const Chart& chart) {
  JsonWriter json;
  json.begin_object()
      .member("title", chart.study.title)
      .member("scene", chart.study.scene)
      .member("error", chart.study.error.name);
  json.member("reference_error", chart.reference_error).key("points").begin_array();
  for (const auto& p : chart.points) {
    json.begin_object()
        .member("method", p.method.name)
        .member("settings", p.method.settings())
        .member("time", p.time)
        .member("time_spread", p.time_spread);
    if (p.good() && !std::isnan(p.error)) json.member("error", p.error);
    for (std::size_t k = 0; p.good() && k < p.more_errors.size(); ++k)
      if (!std::isnan(p.more_errors[k])) json.member("error:" + name_of(chart.study.more_errors[k]), p.more_errors[k]);
    json.member("error_spread", p.error_spread).member("status", p.status);
    if (!p.trouble.empty()) json.member("trouble", p.trouble);
    json.member("residual", p.residual)
        .member("energy_error", p.energy_error)
        .member("overlap_relative", p.overlap_relative)
        .member("ns_per_body_step", p.ns_per_body_step);
    json.member("state_hash", p.state_hash).member("pareto", p.pareto).member("accurate", p.accurate).end_object();
  }
  json.end_array();
  if (chart.recommended) {
    json.key("recommended").begin_array();
    for (const auto& o : chart.points[*chart.recommended].method.overrides) json.value(o);
    json.end_array();
  }
  if (chart.again) {
    json.key("again").begin_object().member("settings", chart.again->settings).member("holds", chart.again->holds);
    json.member("error", chart.again->error).end_object();
  }
  json.end_object();
  return json.text() + "\n";
}

namespace {
/// The first failed point of each method and status with its reason, and the number of its further ones.
std::string failures(const Chart& chart) {
  std::string out;
  const auto same = [](const ChartPoint& p, const ChartPoint& q) {
    return !q.good() && q.method.name == p.method.name && q.status == p.status;
  };
  for (std::size_t k = 0; k < chart.points.size(); ++k) {
    const ChartPoint& p = chart.points[k];
    const auto alike = [&](const ChartPoint& q) { return same(p, q); };
    const auto here = chart.points.begin() + static_cast<std::ptrdiff_t>(k);
    if (p.good() || std::any_of(chart.points.begin(), here, alike)) continue;
    out += fmt::format("failed: {} [{}]: {}{}{}\n", p.method.name, p.method.settings(), p.status,
                       p.trouble.empty() ? "" : ": ", p.trouble);
    if (const auto more = std::count_if(here + 1, chart.points.end(), alike); more > 0)
      out += fmt::format("  and {} more settings: {}\n", more, p.status);
  }
  return out;
}
}  // namespace

std::string chart_verdict(const Chart& chart) {
  std::string out = failures(chart);
  const auto below = std::count_if(chart.points.begin(), chart.points.end(), [&](const ChartPoint& p) {
    return p.good() && !p.is_reference && p.error < 2 * chart.reference_error;
  });
  if (below > 0)
    out += fmt::format(
        "error floor: {} points lie below twice the reference's own error of {:.3g}; their order means nothing\n",
        below, chart.reference_error);
  if (!chart.one_question && !chart.asks_accuracy) return out;
  if (!chart.asks_accuracy) return out + "the scene has no [accuracy]: no method can be recommended\n";
  if (!chart.recommended) return out + "no method of the study meets [accuracy]\n";
  const ChartPoint& best = chart.points[*chart.recommended];
  out += fmt::format(
      "cheapest method inside [accuracy]: {}: {:.3g} {} (spread {:.2g}), error "
      "{:.3g}\n",
      best.method.name, best.time, chart.time_label, best.time_spread, best.error);
  for (const auto& o : best.method.overrides)
    out += o.substr(0, o.find('=')) + " = " + o.substr(o.find('=') + 1) + "\n";
  if (chart.again)
    out += fmt::format("run again with [{}]: {} [accuracy], error {:.3g}{}{}\n", chart.again->settings,
                       chart.again->holds ? "meets" : "does NOT meet", chart.again->error,
                       chart.again->trouble.empty() ? "" : ": ", chart.again->trouble);
  return out;
}

std::string recommended_scene(const Chart& chart, const fs::path& folder) {
  if (!chart.recommended) return {};
  std::string out = "# The cheapest method inside [accuracy], as measured by `epafi chart " + chart.study.file + "`\n";
  out += "include = [\"" + fs::relative(chart.study.scene, folder).generic_string() + "\"]\n";
  auto lines = chart.study.fixed;
  const auto& more = chart.points[*chart.recommended].method.overrides;
  lines.insert(lines.end(), more.begin(), more.end());
  const auto key = [](const std::string& line) { return line.substr(0, line.find('=')); };
  for (auto o = lines.begin(); o != lines.end(); ++o) {
    const bool later = std::any_of(o + 1, lines.end(), [&](const std::string& l) { return key(l) == key(*o); });
    if (!later) out += key(*o) + " = " + o->substr(o->find('=') + 1) + "\n";  // what the method sets wins over `set`
  }
  return out;
}

namespace {

/// Error over time, a line per method, by one of the study's measures.
ScatterPlot error_over_time(const Chart& chart, std::size_t measure) {
  const Study& study = chart.study;
  const auto error = [&](const ChartPoint& p) { return measure == 0 ? p.error : p.more_errors[measure - 1]; };
  const auto has_error = [&](const ChartPoint& p) {
    return p.good() && measure <= p.more_errors.size() && !std::isnan(error(p));
  };
  ScatterPlot plot;
  plot.joined = chart.one_question;
  plot.x_label = chart.time_label;
  plot.y_label = (measure == 0 ? study.error : study.more_errors[measure - 1]).axis_label();
  double least = INFINITY;
  for (const auto& p : chart.points)
    if (has_error(p) && error(p) > 0) least = std::min(least, error(p));
  const double floor = std::isfinite(least) ? 0.5 * least : 1e-16;  // an error of exactly 0 has no place on a log axis
  for (const auto& p : chart.points) {
    auto line =
        std::find_if(plot.lines.begin(), plot.lines.end(), [&](const PlotLine& l) { return l.label == p.method.name; });
    if (line == plot.lines.end()) line = plot.lines.insert(plot.lines.end(), PlotLine{p.method.name, {}, {}, {}});
    if (has_error(p)) {
      line->points.push_back({p.time, std::max(error(p), floor)});
      line->bars.push_back({p.least_time, p.least_time + p.time_spread});
    } else if (p.status != "not_run")
      line->failed.push_back(p.time);
  }
  if (chart.one_question)
    for (const std::size_t k : front_of(chart, measure))
      plot.front.push_back({chart.points[k].time, std::max(error(chart.points[k]), floor)});
  const double own = measure == 0 ? chart.reference_error : chart.more_reference_errors[measure - 1];
  if (own > 0) plot.levels.push_back({"error of the reference itself", own});
  if (measure == 0 && chart.accuracy) plot.levels.push_back({"[accuracy]", *chart.accuracy});
  if (measure == 0 && chart.recommended)
    plot.marked = {{chart.points[*chart.recommended].time, std::max(chart.points[*chart.recommended].error, floor)}};
  return plot;
}

/// Time over the study's axis, a line per method.
ScatterPlot time_over_axis(const Chart& chart) {
  ScatterPlot plot;
  plot.x_label = chart.study.axis_label;
  plot.y_label = chart.time_label;
  for (const auto& p : chart.points) {
    auto line =
        std::find_if(plot.lines.begin(), plot.lines.end(), [&](const PlotLine& l) { return l.label == p.method.name; });
    if (line == plot.lines.end()) line = plot.lines.insert(plot.lines.end(), PlotLine{p.method.name, {}, {}, {}});
    if (p.good())
      line->points.push_back({*p.at, p.time});
    else if (p.status != "not_run")
      line->failed.push_back(*p.at);
  }
  return plot;
}

}  // namespace

void draw_chart(const Chart& chart, const fs::path& folder) {
  const std::string title = chart.study.title.empty() ? fs::path(chart.study.file).stem().string() : chart.study.title;
  for (std::size_t k = 0; k <= chart.study.more_errors.size(); ++k) {
    ScatterPlot plot = chart.study.axis.empty() ? error_over_time(chart, k) : time_over_axis(chart);
    plot.title = title;
    draw(plot, folder / (k == 0 ? "chart" : fmt::format("chart_{}", k + 1)));
  }
}

}  // namespace epafi
