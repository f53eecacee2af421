/// @file scene_run.h  Runs a scene of the library inside a test, without files.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "scenes/assemble.h"
#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "viz_export/output/output_observers.h"

namespace epafi::experiments {

struct SceneRun {
  std::unique_ptr<Assembly> assembly;
  std::vector<MeasureRecorder*> recorders;
  std::string failure;  ///< empty when the run went through

  Simulation& simulation() { return *assembly->simulation; }
  std::string hash() { return state_hash(simulation().world); }
  double last(const std::string& measure, const std::string& component) const { return of(measure, component).last; }
  double largest(const std::string& measure, const std::string& component) const { return of(measure, component).max; }
  double smallest(const std::string& measure, const std::string& component) const { return of(measure, component).min; }
  /// Steps until `steps` are done in all (0: to the end of the scene).
  void advance_to(std::uint64_t steps) {
    Simulation& sim = simulation();
    const std::uint64_t end = steps == 0 ? assembly->steps : steps;
    while (sim.steps() < end && failure.empty())
      if (const auto f = sim.advance(sim.steps() + 1 == end)) failure = f->text;
  }
  double energy_error() {
    simulation().ledger.measure(simulation().world);
    return simulation().ledger.relative_error();
  }

 private:
  RunSummary::Component of(const std::string& measure, const std::string& component) const {
    for (const auto* r : recorders)
      if (r->name() == measure) return r->summary().at(component);
    throw std::out_of_range("no measure " + measure);
  }
};

inline std::string library(const std::string& scene) {
  return std::string(EPAFI_SOURCE_DIR) + "/scenes/library/" + scene;
}

inline SceneRun prepare(ReadResult read) {
  if (!read.scene) throw SceneError(read.problems);
  SceneRun run;
  run.assembly = assemble(std::move(*read.scene));
  const Scene& scene = run.assembly->scene;
  for (const auto& spec : scene.measures) {
    auto recorder = std::make_unique<MeasureRecorder>(spec.name, run.assembly->measure(spec), nullptr, nullptr,
                                                      EverySteps::of_time(spec.interval, run.simulation().time_step));
    run.recorders.push_back(recorder.get());
    run.simulation().observers.push_back(std::move(recorder));
  }
  return run;
}

/// Ready, not started: start(run) or load a state.
inline SceneRun prepare_scene(const std::string& path, const std::vector<std::string>& overrides) {
  return prepare(read_scene(path, overrides, full_registry()));
}

/// A scene written in a test, started; steps: none done yet.
inline SceneRun start_text(const std::string& text, const std::vector<std::string>& overrides = {}) {
  SceneRun run = prepare(read_scene_text(text, "scene.toml", overrides, full_registry()));
  run.simulation().start();
  return run;
}

/// A library scene, started and run for `steps` steps (0: to its end).
inline SceneRun run_scene(const std::string& scene, const std::vector<std::string>& overrides = {},
                          std::uint64_t steps = 0) {
  SceneRun run = prepare_scene(library(scene), overrides);
  run.simulation().start();
  run.advance_to(steps);
  return run;
}

}  // namespace epafi::experiments
