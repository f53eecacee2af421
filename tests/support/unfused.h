/// @file unfused.h  A scene without the loop over spheres: every contact through the generic loop, which is the
/// reference of the other.
#pragma once
#include "detection/broad/all_broad_phases.h"
#include "detection/narrow/narrow_phase.h"
#include "scenes/contact_setup.h"
#include "tests/support/scene_run.h"

namespace epafi::experiments {

inline SceneRun unfused(SceneRun run) {
  Assembly& a = *run.assembly;
  a.simulation->pipeline.narrow_phase =
      std::make_unique<BatchNarrowPhase>(*a.shapes, a.plan.reach, a.plan.needs.curvature);
  a.simulation->pipeline.contact_model = make_contact_model(a.scene);
  const World& world = a.simulation->world;
  BroadSetup all{a.shapes.get(), a.plan.reach};  // no pair is listed apart
  a.simulation->pipeline.broad_phase = make_broad_phase("spatial-hash", all, world);
  return run;
}

/// Bodies of `from` in `to`: both start there without springs.
inline void copy_state(SceneRun& from, SceneRun& to) {
  World &a = from.simulation().world, &b = to.simulation().world;
  for (std::uint32_t id = 0; id < a.ids_given(); ++id) {
    const Slot s = a.slot_of(static_cast<BodyId>(id)), t = b.slot_of(static_cast<BodyId>(id));
    b.position[t] = a.position[s];
    b.velocity[t] = a.velocity[s];
    if (a.cell) b.wraps[t] = a.wraps[s];
    if (a.has_orientation()) b.orientation[t] = a.orientation[s];
    if (a.rotates()) b.set_angular_velocity(t, a.angular_velocity[s]);
  }
  b.cell = a.cell;
}

struct Difference {
  double force = 0, torque = 0, velocity = 0;
};

inline Difference compare(SceneRun& x, SceneRun& y) {
  World &a = x.simulation().world, &b = y.simulation().world;
  Difference worst, scale;
  for (std::uint32_t id = 0; id < a.ids_given(); ++id) {
    const Slot s = a.slot_of(static_cast<BodyId>(id)), t = b.slot_of(static_cast<BodyId>(id));
    if (s == no_slot || !a.is_movable(s)) continue;  // poured later
    worst.force = std::max(worst.force, (a.force[s] - b.force[t]).norm());
    scale.force = std::max(scale.force, a.force[s].norm());
    if (a.rotates()) {
      worst.torque = std::max(worst.torque, (a.torque[s] - b.torque[t]).norm());
      scale.torque = std::max(scale.torque, a.torque[s].norm());
    }
    worst.velocity = std::max(worst.velocity, (a.velocity[s] - b.velocity[t]).norm());
    scale.velocity = std::max(scale.velocity, a.velocity[s].norm());
  }
  return {worst.force / scale.force, a.rotates() ? worst.torque / scale.torque : 0.0, worst.velocity / scale.velocity};
}

}  // namespace epafi::experiments
