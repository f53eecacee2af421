/// @file assemble.h  From a validated scene to a simulation that can step.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "detection/narrow/narrow_phase.h"
#include "engine/rolling_regions.h"
#include "engine/simulation.h"
#include "engine/sources.h"
#include "scenes/monitor.h"
#include "scenes/plan.h"
#include "viz_export/body_origin.h"
#include "viz_export/measures/measure.h"

namespace epafi {

/// The time step and where it came from.
struct TimeStep {
  double value = 0.0;  ///< [s]
  double limit = 0.0;  ///< stability or accuracy limit [s]; infinite where there is none
  std::string reason;
  std::string limit_reason{};  ///< of the limit; empty: that of the step
  std::function<int(const World&)> parts{};  ///< of "adaptive": into how many parts a step is divided
};

/// A scene made ready. The scene, the shapes and the simulation live together: observers refer to them.
struct Assembly {
  Scene scene;
  StepPlan plan;
  TimeStep time_step;
  std::uint64_t steps = 0;  ///< of the whole duration
  std::shared_ptr<ShapeStore> shapes;
  std::unique_ptr<RollingRegions> rolling;  ///< of wheels on rails, between search and law; null without
  std::unique_ptr<Simulation> simulation;
  std::vector<std::vector<BodyId>> fill_ids;  ///< of Scene::fills; those that are poured have no slot before they come
  std::vector<const PourBodies*> sources;
  BatchNarrowPhase* narrow_phase = nullptr;  ///< of the pipeline
  ShapeOrigins origins;                      ///< of shapes in use, for files that are read back
  std::vector<Problem> warnings;

  /// Of Scene::bodies[k]: the world has them first.
  static BodyId body_id(std::size_t k) { return static_cast<BodyId>(k); }
  BodyIds ids(const NamedBodies& named) const;
  /// A measure of the scene, made once more.
  std::unique_ptr<Measure> measure(const MeasureSpec& spec) const;
};

/// Builds shapes, plan, world and stages. Throws SceneError for what only shows now (geometry, missing constants, time
/// step above its limit, overlapping parts of laws). Observers are not part of it: see observe.h.
std::unique_ptr<Assembly> assemble(Scene scene);

/// Body's name for messages: "stack[3]" or "body 17".
std::string body_name(const Assembly& assembly, BodyId id);

}  // namespace epafi
