/// @file assemble.h  From a validated scene to a simulation that can step.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "detection/narrow/narrow_phase.h"
#include "engine/railway/rolling_regions.h"
#include "engine/step/simulation.h"
#include "engine/step/sources.h"
#include "scenes/generators.h"
#include "scenes/monitor.h"
#include "scenes/plan.h"
#include "scenes/run_record.h"
#include "viz_export/files/body_origin.h"
#include "viz_export/measures/measure.h"

namespace epafi {

/// A scene made ready. The scene, the shapes and the simulation live together: observers refer to them.
struct Assembly {
  Scene scene;
  StepPlan plan;
  TimeStep time_step;
  std::uint64_t steps = 0;  ///< of the whole duration, or of the present stage
  std::shared_ptr<ShapeStore> shapes;
  std::unique_ptr<RollingRegions> rolling;  ///< of wheels on rails, between search and law; null without
  std::unique_ptr<Simulation> simulation;
  std::vector<std::vector<BodyId>> fill_ids;  ///< of Scene::fills; those that are poured have no slot before they come
  std::vector<const PourBodies*> sources;
  BatchNarrowPhase* narrow_phase = nullptr;  ///< of the pipeline
  ShapeOrigins origins;                      ///< of shapes in use, for files that are read back
  std::vector<Problem> warnings;
  std::vector<double> clocks;    ///< of the stages before the present one, at their ends [s]
  std::vector<BodyId> body_ids;  ///< of Scene::bodies; empty: the world has them first, in their order
  KnownFills fill_bodies;        ///< of Scene::fills, if needed

  /// A driven body, and the stage that set its motion.
  struct Drive {
    BodyId body;
    Since since;
  };
  std::vector<Drive> drives;

  /// Id of Scene::bodies[k] where no stage has added bodies: these come first in the world.
  static BodyId body_id(std::size_t k) { return static_cast<BodyId>(k); }
  /// Id of Scene::bodies[k].
  BodyId id_of(std::size_t k) const { return body_ids.empty() ? static_cast<BodyId>(k) : body_ids[k]; }
  /// Time since `since` at the begin of the present stage [s].
  double elapsed(const Since& since) const;
  BodyIds ids(const NamedBodies& named) const;
  /// A measure of the scene, made once more.
  std::unique_ptr<Measure> measure(const MeasureSpec& spec) const;
};

/// Options for a simulation that continues another one, or whose bodies are read afterwards.
struct AssembleOptions {
  std::vector<double> clocks{};            ///< Assembly::clocks
  std::optional<TimeStep> time_step{};     ///< taken as it is
  std::function<void(Assembly&)> place{};  ///< sets the positions of bodies before any choice depends on them
  bool may_fuse = true;                    ///< spheres may use the fused loop
  KnownFills fill_bodies{};                ///< by fill, where they are known; others are placed
  bool keep_fill_bodies = false;
  bool places_known = true;  ///< false: bodies will have moved by then, so fills do not test for room
};

/// Builds shapes, plan, world and stages. Throws SceneError for problems that appear only now (geometry, missing
/// constants, time step above its limit, overlapping parts of laws). Observers are not part of it: see observe.h.
std::unique_ptr<Assembly> assemble(Scene scene, const AssembleOptions& options = {});

/// Body's name for messages: "stack[3]" or "body 17".
std::string body_name(const Assembly& assembly, BodyId id);

}  // namespace epafi
