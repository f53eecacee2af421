#include "scenes/study/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/study/case_run.h"
#include "scenes/study/study_error.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

Strings joined(Strings a, const Strings& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Every case must be a scene before the first is run; tells whether the scene asks for an accuracy.
bool check_cases(const Study& study) {
  std::vector<Strings> all;
  for (const auto& m : study.methods) all.push_back(joined(study.fixed, m.overrides));
  if (study.has_reference) all.push_back(joined(study.fixed, study.reference));
  bool asks = false;
  for (const auto& overrides : all) {
    const ReadResult read = read_scene(study.scene, overrides, full_registry());
    if (!read.scene) throw SceneError(read.problems);
    asks = asks || !read.scene->accuracy.empty();
    static const Strings plain{"overlap", "energy", "residual", "momentum", "distance"};
    const auto& measures = read.scene->measures;
    const bool known =
        std::find(plain.begin(), plain.end(), study.error.name) != plain.end() ||
        std::any_of(measures.begin(), measures.end(), [&](const MeasureSpec& m) { return m.name == study.error.name; });
    if (!known)
      throw SceneError("error = '" + study.error.name + "' is no measure of " + study.scene +
                       "; write overlap, energy, residual, momentum, distance or the name of a [[measure]]");
  }
  return asks;
}

struct Runner {
  const Study& study;
  fs::path folder;
  CaseLimits limits;
  Yardstick yardstick;
  double reference_error = 0.0;
  std::function<void(const std::string&)> say;

  Case reference_case(const char* name, const Strings& more) const {
    return {joined(joined(study.fixed, study.reference), more), folder / name};
  }

  /// The reference run and the same at half the time step: the finer one is the yardstick, their difference its error.
  void run_reference() {
    if (!study.has_reference) return;
    CaseLimits long_limits = limits;
    long_limits.seconds *= 20;  // the yardstick may cost more than what it judges
    const Case coarse = reference_case("reference_coarse", {});
    const CaseResult first = run_case(study.scene, coarse, long_limits);
    if (!first.completed()) throw SceneError("the reference run ended as '" + first.status + "': " + first.trouble);
    const Case fine =
        reference_case("reference", {fmt::format("run.time_step={}", 0.5 * first.number("time_step", 0.0))});
    const CaseResult second = run_case(study.scene, fine, long_limits);
    if (!second.completed())
      throw SceneError("the reference run at half the time step ended as '" + second.status + "': " + second.trouble);
    yardstick = {measured(study.error, second), fine.folder};
    reference_error = study_error(study.error, first, coarse.folder, yardstick).value_or(0.0);
    say(fmt::format("reference: its own error is {:.3g}", reference_error));
  }

  void add(ChartPoint& p, const Case& wanted, const CaseResult& r, std::vector<double>& times) const {
    const std::string hash = r.summary.text("state_hash");
    const bool first = times.empty();
    if (first)
      p.status = r.status, p.trouble = r.trouble, p.state_hash = hash;
    else if (p.good() && (r.status != p.status || hash != p.state_hash))
      p.status = "differs", p.trouble = "repeats ended in different states";
    const double span = r.number("simulated_time", 0.0);
    times.push_back(span > 0 ? r.number("cpu_time", 0.0) / span : 0.0);
    p.ns_per_body_step =
        first ? r.number("ns_per_body_step", 0.0) : std::min(p.ns_per_body_step, r.number("ns_per_body_step", 0.0));
    if (!first || r.summary.numbers.empty()) return;
    p.residual = r.summary.number("residual.max"), p.energy_error = r.summary.number("energy.relative_error"),
    p.overlap_relative = r.summary.number("overlap.max_relative");
    p.error_spread = reference_error;
    if (const auto e = study_error(study.error, r, wanted.folder, yardstick))
      p.error = *e;
    else if (p.good())
      p.status = "no_error", p.trouble = "the run has no '" + study.error.name + "' to compare";
    p.accurate = true;
    for (const auto& [name, value] : r.summary.numbers)
      if (name.compare(0, 9, "accuracy.") == 0 && name.size() > 3 && name.compare(name.size() - 3, 3, ".ok") == 0)
        p.accurate = p.accurate && value > 0;
  }
};

}  // namespace

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  const std::size_t n = v.size();
  return n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

void set_times(ChartPoint& point, const std::vector<double>& times) {
  point.time = median(times);
  point.time_spread = *std::max_element(times.begin(), times.end()) - *std::min_element(times.begin(), times.end());
}

void mark_front(Chart& chart) {
  std::vector<ChartPoint*> good;
  for (auto& p : chart.points)
    if (p.good() && !p.is_reference) good.push_back(&p);
  std::stable_sort(good.begin(), good.end(), [](const ChartPoint* a, const ChartPoint* b) {
    return std::tie(a->time, a->error) < std::tie(b->time, b->error);
  });
  double best = INFINITY;
  for (ChartPoint* p : good)
    if (p->error < best) p->pareto = true, best = p->error;
  if (!chart.asks_accuracy) return;
  for (const ChartPoint* p : good)
    if (p->accurate) {
      chart.recommended = static_cast<std::size_t>(p - chart.points.data());
      return;
    }
}

Chart run_chart(const Study& study, const fs::path& folder, const std::function<void(const std::string&)>& say) {
  Chart chart;
  chart.study = study;
  chart.asks_accuracy = check_cases(study);
  Runner runner{study, folder, {study.program, study.threads, study.time_limit, true}, {}, 0.0, say};
  runner.run_reference();
  chart.reference_error = runner.reference_error;
  std::vector<Case> cases;
  for (std::size_t k = 0; k < study.methods.size(); ++k) {
    cases.push_back({joined(study.fixed, study.methods[k].overrides), folder / fmt::format("case_{:03}", k)});
    chart.points.push_back({});
    chart.points.back().method = study.methods[k];
    chart.points.back().is_reference = study.has_reference && study.methods[k].overrides == study.reference;
  }
  if (!cases.empty()) chart.command = command_line(study.scene, cases.front(), runner.limits);
  std::vector<std::vector<double>> times(cases.size());
  for (int round = 0; round < study.repeats; ++round) {
    for (std::size_t k = 0; k < cases.size(); ++k) {
      ChartPoint& p = chart.points[k];
      if (round > 0 && !p.good()) continue;
      const CaseResult r = run_case(study.scene, cases[k], runner.limits);
      if (r.status == "interrupted") throw FileError("interrupted");
      runner.add(p, cases[k], r, times[k]);
      if (round == 0)
        say(fmt::format("{}/{} {} [{}]: {}, {:.3g} s per s, error {:.3g}", k + 1, cases.size(), p.method.name,
                        p.method.settings(), p.status, times[k].back(), p.error));
    }
  }
  for (std::size_t k = 0; k < cases.size(); ++k) set_times(chart.points[k], times[k]);
  mark_front(chart);
  return chart;
}

}  // namespace epafi
