#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/study/case_run.h"
#include "scenes/study/chart.h"
#include "scenes/study/study_error.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

Strings joined(Strings a, const Strings& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// The setting of a key among overrides, empty where it is not set.
std::string setting_of(const Strings& overrides, const std::string& key) {
  std::string last;
  for (const auto& o : overrides)
    if (!key.empty() && o.compare(0, key.size() + 1, key + "=") == 0) last = o;
  return last;
}

void check_error(const ErrorSpec& error, const Scene& scene, const std::string& file) {
  static const Strings plain{"overlap", "energy", "residual", "momentum", "distance"};
  const bool known = std::find(plain.begin(), plain.end(), error.name) != plain.end() ||
                     std::any_of(scene.measures.begin(), scene.measures.end(),
                                 [&](const MeasureSpec& m) { return m.name == error.name; });
  if (!known)
    error.refuse(file, "overlap, energy, residual, momentum, distance or the name of a [[measure]] of the scene");
}

/// Every case must be a scene before the first is run; says whether the scene asks for an accuracy.
bool check_cases(const Study& study) {
  std::vector<Strings> all;
  for (const auto& m : study.methods) all.push_back(joined(study.fixed, m.overrides));
  if (study.has_reference) all.push_back(joined(study.fixed, study.reference));
  if (study.has_again) all.push_back(joined(study.fixed, study.again));
  bool asks = study.accuracy.has_value();
  for (const auto& overrides : all) {
    const ReadResult read = read_scene(study.scene, overrides, full_registry());
    if (!read.scene) throw SceneError(read.problems);
    asks = asks || !read.scene->accuracy.empty();
    check_error(study.error, *read.scene, study.file);
    for (const ErrorSpec& e : study.more_errors) check_error(e, *read.scene, study.file);
  }
  return asks;
}

/// What the cases are compared with, by measure.
struct Truth {
  std::vector<Yardstick> yardsticks;
  std::vector<double> own_errors;
};

struct Runner {
  const Study& study;
  fs::path folder;
  CaseLimits limits;
  std::function<void(const std::string&)> say;
  std::map<std::string, Truth> truths;  ///< by the setting of the axis; one of "" where there is none

  const ErrorSpec& measure(std::size_t k) const { return k == 0 ? study.error : study.more_errors[k - 1]; }
  std::size_t measures() const { return 1 + study.more_errors.size(); }

  CaseResult reference_run(const Case& wanted) const {
    CaseLimits long_limits = limits;
    long_limits.seconds *= 20;  // the yardstick may cost more than what it judges
    if (study.budget > 0) long_limits.seconds = std::min(long_limits.seconds, study.budget);
    CaseResult r = run_case(study.scene, wanted, long_limits);
    if (r.status == "interrupted") throw FileError("interrupted");
    if (!r.completed())
      throw SceneError("the reference run [" + StudyMethod{"", wanted.overrides}.settings() + "] ended as '" +
                       r.status + "': " + r.trouble);
    return r;
  }

  /// The reference run and the same at half the time step: the finer one is the yardstick, their difference its error.
  /// At a place of an axis (what, more: its setting) the reference is another algorithm for the same step: one run.
  Truth find_truth(const std::string& name, const Strings& more) const {
    Truth truth{std::vector<Yardstick>(measures()), std::vector<double>(measures(), 0.0)};
    if (!study.has_reference) return truth;
    const Strings settings = joined(joined(study.fixed, study.reference), more);
    const Case coarse{settings, folder / (name + (study.axis.empty() ? "_coarse" : ""))};
    const CaseResult first = reference_run(coarse);
    Case fine = coarse;
    CaseResult second = first;
    if (study.axis.empty()) {
      fine = {joined(settings, {fmt::format("run.time_step={}", 0.5 * first.number("time_step", 0.0))}), folder / name};
      second = reference_run(fine);
    }
    for (std::size_t k = 0; k < measures(); ++k) {
      truth.yardsticks[k] = {measured(measure(k), second), fine.folder};
      truth.own_errors[k] = study_error(measure(k), first, coarse.folder, truth.yardsticks[k]).value_or(0.0);
    }
    return truth;
  }

  void find_truths() {
    for (const StudyMethod& m : study.methods) {
      const std::string at = setting_of(m.overrides, study.axis);
      if (truths.count(at)) continue;
      truths[at] = find_truth(at.empty() ? "reference" : fmt::format("reference_{}", truths.size()),
                              at.empty() ? Strings{} : Strings{at});
      if (study.has_reference && study.axis.empty())
        for (std::size_t k = 0; k < measures(); ++k)
          say(fmt::format("reference, {}: its own error is {:.3g}", measure(k).name, truths[at].own_errors[k]));
    }
  }

  double time_of(const CaseResult& r) const {
    if (study.cost == Study::Cost::broad_phase)
      return r.number("stage_seconds.broad_phase", 0.0) /
             std::max(1.0, r.number("steps", 0.0) * r.number("bodies", 0.0));
    const double span = r.number("simulated_time", 0.0);
    return span > 0 ? r.number("cpu_time", 0.0) / span : 0.0;
  }

  /// Errors and whether they are small enough, from the first run of a point.
  void judge(ChartPoint& p, const Case& wanted, const CaseResult& r, const Truth& truth) const {
    p.residual = r.summary.number("residual.max");
    p.energy_error = r.summary.number("energy.relative_error");
    p.overlap_relative = r.summary.number("overlap.max_relative");
    p.error_spread = truth.own_errors[0];
    p.more_errors.clear();
    bool has_some = false;  // an error that a method has none of leaves the others as they are
    for (std::size_t k = 0; k < measures(); ++k) {
      const auto e = study_error(measure(k), r, wanted.folder, truth.yardsticks[k]);
      has_some = has_some || e;
      (k == 0 ? p.error : p.more_errors.emplace_back()) = e.value_or(NAN);
    }
    if (!has_some && p.good()) {
      p.status = "no_error";
      p.trouble = "the run has no '" + measure(0).name + "' to compare";
    }
    p.accurate = study.accuracy ? p.error <= *study.accuracy : !std::isnan(p.error);
    for (const auto& [name, value] : r.summary.numbers)
      if (name.compare(0, 9, "accuracy.") == 0 && name.size() > 3 && name.compare(name.size() - 3, 3, ".ok") == 0)
        p.accurate = p.accurate && value > 0;
  }

  void add(ChartPoint& p, const Case& wanted, const CaseResult& r, std::vector<double>& times) const {
    const std::string hash = r.summary.text("state_hash");
    const bool first = times.empty();
    if (first) {
      p.status = r.status;
      p.trouble = r.trouble;
      p.state_hash = hash;
    } else if (p.good() && (r.status != p.status || hash != p.state_hash)) {
      p.status = "differs";
      p.trouble = "repeats ended in different states";
    }
    times.push_back(time_of(r));
    const double ns = r.number("ns_per_body_step", 0.0);
    p.ns_per_body_step = first ? ns : std::min(p.ns_per_body_step, ns);
    if (first && !r.summary.numbers.empty()) judge(p, wanted, r, truths.at(setting_of(p.method.overrides, study.axis)));
  }

  /// The scene's own limit of what the study calls its error, where it has one.
  static std::optional<double> accuracy_of(const ErrorSpec& error, const CaseResult& r) {
    const std::map<std::string, std::string> names{
        {"overlap", "overlap_relative"}, {"energy", "energy_error"}, {"momentum", "momentum_error"}};
    const auto at = names.find(error.name);
    if (error.relative) return std::nullopt;
    const std::string name = "accuracy." + (at == names.end() ? error.name : at->second) + ".", bound = ".bound";
    for (const auto& [key, value] : r.summary.numbers)  // accuracy.overlap_relative.bound, accuracy.drift.GROUP.bound
      if (key.compare(0, name.size(), name) == 0 && key.size() > bound.size() &&
          key.compare(key.size() - bound.size(), bound.size(), bound) == 0)
        return value;
    return std::nullopt;
  }

  /// What is recommended under another seed; a reference run there too, where there is one.
  SecondOpinion run_again(const ChartPoint& best) const {
    SecondOpinion opinion{StudyMethod{"", study.again}.settings(), false, 0.0, {}};
    Truth truth;
    truth = study.accuracy ? find_truth("again_reference", study.again)
                           : Truth{std::vector<Yardstick>(measures()), std::vector<double>(measures(), 0.0)};
    const Case wanted{joined(joined(study.fixed, best.method.overrides), study.again), folder / "again"};
    const CaseResult r = run_case(study.scene, wanted, limits);
    ChartPoint p;
    p.status = r.status;
    p.trouble = r.trouble;
    judge(p, wanted, r, truth);
    opinion.holds = p.good() && p.accurate;
    opinion.error = p.error;
    opinion.trouble = p.trouble;
    if (p.good() && !p.accurate) opinion.trouble = "outside [accuracy]";
    return opinion;
  }
};

/// left: seconds of the study's budget, infinite where it has none.
void run_rounds(Runner& runner, Chart& chart, const std::vector<Case>& cases, const std::function<double()>& left) {
  const Study& study = runner.study;
  std::vector<std::vector<double>> times(cases.size());
  std::size_t number = 0;
  for (int round = 0; round < study.repeats; ++round)
    for (const std::size_t k : order_of_turns(study)) {
      ChartPoint& p = chart.points[k];
      if (round > 0 && (!p.good() || left() <= 0)) continue;
      CaseResult r;
      CaseLimits limits = runner.limits;
      limits.seconds = std::min(limits.seconds, left());
      if (limits.seconds > 0) r = run_case(study.scene, cases[k], limits);
      if (r.status == "interrupted") throw FileError("interrupted");
      if (limits.seconds < runner.limits.seconds && (r.status.empty() || r.status == "over_budget")) {
        if (round == 0) {
          p.status = "not_run";
          p.trouble = "the budget of the study was spent";
        }
        continue;
      }
      runner.add(p, cases[k], r, times[k]);
      if (!chart.accuracy) chart.accuracy = Runner::accuracy_of(study.error, r);
      if (round == 0)
        runner.say(fmt::format("{}/{} {} [{}]: {}, {:.3g} {}, error {:.3g}", ++number, cases.size(), p.method.name,
                               p.method.settings(), p.status, times[k].back(),
                               study.cost == Study::Cost::run ? "s per s" : "s per body and step", p.error));
    }
  for (std::size_t k = 0; k < cases.size(); ++k) set_times(chart.points[k], times[k]);
}

}  // namespace

Chart run_chart(const Study& study, const fs::path& folder, const std::function<void(const std::string&)>& say) {
  Chart chart;
  chart.study = study;
  chart.asks_accuracy = check_cases(study);
  chart.accuracy = study.accuracy;
  if (study.cost == Study::Cost::broad_phase) chart.time_label = "broad phase: seconds per body and step";
  const auto begin = std::chrono::steady_clock::now();
  CaseLimits limits;
  limits.program = study.program;
  limits.threads = study.threads;
  limits.seconds = study.time_limit;
  Runner runner{study, folder, limits, say, {}};
  runner.find_truths();
  const std::vector<double>& own = runner.truths.begin()->second.own_errors;
  chart.reference_error = own[0];
  chart.more_reference_errors.assign(own.begin() + 1, own.end());
  std::vector<Case> cases;
  for (std::size_t k = 0; k < study.methods.size(); ++k) {
    const StudyMethod& m = study.methods[k];
    cases.push_back({joined(study.fixed, m.overrides), folder / fmt::format("case_{:03}", k)});
    ChartPoint& p = chart.points.emplace_back();
    p.method = m;
    p.is_reference = study.has_reference && study.axis.empty() && m.overrides == study.reference;
    if (const std::string at = setting_of(m.overrides, study.axis); !at.empty())
      p.at = std::strtod(at.c_str() + study.axis.size() + 1, nullptr);
    else if (!study.axis.empty())
      throw SceneError(study.file + ": axis '" + study.axis + "': every method of vary must set it");
  }
  chart.one_question = study.axis.empty();
  if (!cases.empty()) chart.command = command_line(study.scene, cases.front(), runner.limits);
  run_rounds(runner, chart, cases, [&] {
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return study.budget > 0 ? study.budget - spent : INFINITY;
  });
  mark_front(chart);
  if (chart.recommended && study.has_again) chart.again = runner.run_again(chart.points[*chart.recommended]);
  return chart;
}

}  // namespace epafi
