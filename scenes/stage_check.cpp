#include "scenes/stage_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/units/nearest.h"

namespace epafi {

void check_component(const Assembly& a, const Condition& condition, const Place& place) {
  for (const MeasureSpec& spec : a.scene.measures) {
    if (spec.name != condition.measure) continue;
    const auto names = a.measure(spec)->components();
    if (std::find(names.begin(), names.end(), condition.component) != names.end()) return;
    throw SceneError("unknown component '" + condition.component + "' of the measure '" + condition.measure + "'" +
                         suggestion(condition.component, names, "components"),
                     place);
  }
}

void check_conditions(const Assembly& a) {
  const StageSpec& stage = a.scene.stages[a.scene.stage];
  if (stage.until) check_component(a, *stage.until, stage.place);
  for (const BoundSpec& bound : a.scene.bounds)
    if (bound.quantity == "measure") check_component(a, bound.broken, bound.place);
}

namespace {

std::string length_text(const StageSpec& stage) {
  if (!stage.until) return fmt::format("{:.6g} s", stage.duration);
  const Condition& c = *stage.until;
  return fmt::format("until {} {} {} {:.6g}{}, at most {:.6g} s", c.measure, c.component, c.above ? ">" : "<", c.limit,
                     c.duration > 0 ? fmt::format(" for {:.6g} s", c.duration) : "", stage.duration);
}

StageCheck check_stage_of(const Scene& first, std::size_t k) {
  Scene scene = first.stage_of(k);
  scene.run.allow_unstable = true;  // the speeds of its beginning are not known yet
  AssembleOptions options;
  options.clocks.assign(k, 0.0);
  options.places_known = false;
  const auto a = assemble(std::move(scene), options);
  check_conditions(*a);
  const StageSpec& stage = a->scene.stages[k];
  const std::string title = fmt::format("stage '{}'", stage.name);
  const bool beyond = a->time_step.value > a->time_step.limit;
  const std::string limit =
      beyond ? fmt::format("  its limit     {:.4g} s: {}; the run ends here with an error if that is so then\n",
                           a->time_step.limit, a->time_step.limit_reason)
             : "";
  return {fmt::format("{}: {}\n  time step     {:.6g} s, from where the scene begins: {}\n{}  steps         {}{}\n",
                      title, length_text(stage), a->time_step.value, a->time_step.reason, limit,
                      stage.until ? "at most " : "", a->steps),
          fmt::format("\n{}\n", title) + explain(a->scene, a->plan, *a->shapes), static_cast<double>(a->steps),
          std::floor(stage.duration / a->scene.run.output_interval.value), a->warnings};
}

}  // namespace

std::vector<StageCheck> check_stages(const Scene& scene) {
  std::vector<StageCheck> all;
  if (!scene.stage_of) return all;
  const StageSpec& first = scene.stages[scene.stage];
  all.push_back({fmt::format("stage '{}', the first: {}\n", first.name, length_text(first)), "", 0.0, 0.0});
  for (std::size_t k = scene.stage + 1; k < scene.stages.size(); ++k) all.push_back(check_stage_of(scene, k));
  return all;
}

}  // namespace epafi
