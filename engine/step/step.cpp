#include "engine/step/step.h"

namespace epafi {

namespace {

/// Half a step of the scheme, with the motion guard if the scene has one.
template <class Half>
double watched(World& world, Pipeline& stage, double dt, const Half& half) {
  if (!stage.guard) {
    half();
    return 0.0;
  }
  stage.guard->remember(world);
  half();
  return stage.guard->hold_back(world, 0.5 * dt);
}

}  // namespace

void step(World& world, Pipeline& stage, Workspace& work, double dt) {
  StageTimer timer(work.report.seconds);
  step(world, stage, work, dt, timer);
}

void step(World& world, Pipeline& stage, Workspace& work, double dt, StageTimer& timer, const RunOn* run_on,
          bool begun) {
  work.report.deepest = work.report.deepest_relative = 0.0;
  work.report.doubts.clear();
  StepClock clock{dt, stage.scheme->velocity_lag(), stage.scheme.get(), nullptr, run_on};
  double held = 0.0;
  if (begun) {
    clock.scheme = nullptr;
  } else if (stage.guard || !stage.contact_model->move(world, clock)) {
    clock.scheme = nullptr;
    held = watched(world, stage, dt, [&] { stage.scheme->first_half(world, dt); });
  }
  timer.lap(Stage::integrate);
  if (!stage.broad_phase->keeps_pairs(world)) stage.broad_phase->find_pairs(world, work.pairs);
  timer.lap(Stage::broad_phase);
  stage.narrow_phase->collide(world, work.pairs, work.contacts);
  stage.narrow_phase->unite(world, work.contacts);
  timer.lap(Stage::narrow_phase);
  stage.contact_model->act(world, work.contacts, clock, work.report);
  timer.lap(Stage::contact);
  if (!clock.scheme) held += watched(world, stage, dt, [&] { stage.scheme->second_half(world, dt); });
  work.report.correction += held;
  world.time += dt;
  world.clock += dt;
  world.fallen += dt * world.gravity;
  timer.lap(Stage::integrate);
}

void evaluate_forces(World& world, Pipeline& stage, Workspace& work) {
  stage.broad_phase->find_pairs(world, work.pairs);
  stage.narrow_phase->collide(world, work.pairs, work.contacts);
  stage.narrow_phase->unite(world, work.contacts);
  work.report.deepest = work.report.deepest_relative = 0.0;
  work.report.doubts.clear();
  stage.contact_model->act(world, work.contacts, {0.0, 0.0}, work.report);
}

}  // namespace epafi
