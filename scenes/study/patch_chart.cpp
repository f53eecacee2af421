#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "scenes/patch/evaluate_patch.h"
#include "scenes/reader/document.h"
#include "scenes/study/chart.h"
#include "scenes/study/limits.h"

namespace epafi {
namespace {

std::vector<PatchResult> evaluate(const Study& study, const std::vector<std::string>& overrides) {
  std::vector<std::string> all = study.fixed;
  all.insert(all.end(), overrides.begin(), overrides.end());
  const PatchReading reading = read_patch(study.scene, all);
  if (!reading.patch) throw SceneError(reading.problems);
  return evaluate_patch(*reading.patch);
}

/// One pair of models per point: a method that leaves several open is refused.
PatchResult single(const Study& study, const std::vector<std::string>& overrides) {
  const auto results = evaluate(study, overrides);
  if (results.size() != 1)
    throw SceneError(
        fmt::format("{}: [{}] evaluates {} pairs of models; set patch.normal and patch.tangential to one each",
                    study.file, StudyMethod{"", overrides}.settings(), results.size()));
  return results.front();
}

double error_of(const std::string& name, const PatchResult& r, const PatchResult& reference) {
  const double pressure = std::abs(r.max_pressure / reference.max_pressure - 1.0),
               area = std::abs(r.area / reference.area - 1.0);
  const double force =
      std::hypot(r.force.fx - reference.force.fx, r.force.fy - reference.force.fy) / reference.normal_force;
  if (name == "pressure") return pressure;
  if (name == "area") return area;
  if (name == "force") return force;
  return std::max({pressure, area, force});
}

/// The recommended models under the study's `again`, against the reference there.
SecondOpinion evaluate_again(const Study& study, const ChartPoint& best) {
  const auto there = [&](std::vector<std::string> settings) {
    settings.insert(settings.end(), study.again.begin(), study.again.end());
    return single(study, settings);
  };
  const PatchResult r = there(best.method.overrides);
  SecondOpinion opinion{StudyMethod{"", study.again}.settings(), false, 0.0, {}};
  opinion.error = error_of(study.error.name, r, there(study.reference));
  opinion.holds = r.reasons.empty() && opinion.error <= *study.accuracy;
  if (!opinion.holds) opinion.trouble = r.reasons.empty() ? "outside the accuracy asked for" : r.reasons.front();
  return opinion;
}

std::string join(const std::vector<std::string>& parts) {
  std::string all;
  for (const auto& p : parts) all += (all.empty() ? "" : "; ") + p;
  return all;
}

}  // namespace

bool is_patch_study(const Study& study) {
  return load_document(study.scene, study.fixed).root.find("patch") != nullptr;
}

LimitCase judge_patch_case(const Study& study, std::size_t method, const std::vector<std::string>& parameters,
                           const std::vector<double>& at) {
  if (!study.has_reference || study.fails_when.empty())
    throw SceneError(study.file +
                     ": limits of a patch need a reference and fails_when = { pressure | area | force | patch = }");
  const auto with = [&](std::vector<std::string> settings) {
    settings.insert(settings.end(), parameters.begin(), parameters.end());
    return settings;
  };
  // a parameter that the reference sets itself (its own grid) is not the study's to vary there
  std::vector<std::string> reference = parameters;
  reference.insert(reference.end(), study.reference.begin(), study.reference.end());
  const PatchResult r = single(study, with(study.methods[method].overrides)), truth = single(study, reference);
  LimitCase c{method, at, "ok", {}, {}, {}};
  for (const FailureSpec& f : study.fails_when) {
    const double error = error_of(f.quantity, r, truth);
    c.detail = fmt::format("{} = {:.3g}", f.quantity, error);
    if (!(error > f.limit)) continue;
    c.status = "failed";
    c.kind = r.reasons.empty() ? "wrong and not flagged" : "wrong and flagged";
    break;
  }
  return c;
}

Chart run_patch_chart(const Study& study, const std::function<void(const std::string&)>& say) {
  static const std::vector<std::string> known{"pressure", "area", "force", "patch"};
  if (std::find(known.begin(), known.end(), study.error.name) == known.end())
    study.error.refuse(study.file, "pressure, area, force or patch");
  if (!study.has_reference)
    throw SceneError(study.file +
                     ": a study of a patch needs a reference, for example the half-space method on a fine grid");
  Chart chart;
  chart.study = study;
  chart.time_label = "processor seconds per evaluation";
  const PatchResult reference = single(study, study.reference);
  chart.reference_error = reference.error_estimate;
  say(fmt::format("reference: its own error is {:.3g}", chart.reference_error));
  std::vector<std::vector<double>> times(study.methods.size());
  chart.asks_accuracy = study.accuracy.has_value();
  chart.accuracy = study.accuracy;
  for (const StudyMethod& m : study.methods) chart.points.emplace_back().method = m;
  const auto begin = std::chrono::steady_clock::now();
  const auto spent = [&] {
    return study.budget > 0 &&
           std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() > study.budget;
  };
  for (int round = 0; round < study.repeats; ++round)
    for (const std::size_t k : order_of_turns(study)) {
      ChartPoint& p = chart.points[k];
      if (spent()) {
        if (round == 0) {
          p.status = "not_run";
          p.trouble = "the budget of the study was spent";
        }
        continue;
      }
      const PatchResult r = single(study, study.methods[k].overrides);
      times[k].push_back(1e-3 * r.milliseconds);
      if (round > 0) continue;
      p.status = r.reasons.empty() ? "completed" : "outside_its_range";
      p.trouble = join(r.reasons);
      p.error = error_of(study.error.name, r, reference);
      p.error_spread = chart.reference_error;
      p.is_reference = p.method.overrides == study.reference;
      p.accurate = !study.accuracy || p.error <= *study.accuracy;
      say(fmt::format("{}/{} {} [{}]: {}, {:.3g} ms, error {:.3g}", k + 1, study.methods.size(), p.method.name,
                      p.method.settings(), p.status, r.milliseconds, p.error));
    }
  for (std::size_t k = 0; k < times.size(); ++k) set_times(chart.points[k], times[k]);
  mark_front(chart);
  if (chart.recommended && study.has_again) chart.again = evaluate_again(study, chart.points[*chart.recommended]);
  chart.command = "epafi patch " + study.scene + " --json";
  return chart;
}

}  // namespace epafi
