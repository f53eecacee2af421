#include "engine/step.h"

namespace epafi {

void step(World& world, Pipeline& stage, Workspace& work, double dt) {
  StageTimer timer(work.report.seconds);
  stage.scheme->first_half(world, dt);
  timer.lap(Stage::integrate);
  stage.broad_phase->find_pairs(world, work.pairs);
  timer.lap(Stage::broad_phase);
  stage.narrow_phase->collide(world, work.pairs, work.contacts);
  timer.lap(Stage::narrow_phase);
  stage.contact_model->act(world, work.contacts, {dt, stage.scheme->velocity_lag()}, work.report);
  timer.lap(Stage::contact);
  stage.scheme->second_half(world, dt);
  world.time += dt;
  timer.lap(Stage::integrate);
}

void evaluate_forces(World& world, Pipeline& stage, Workspace& work) {
  stage.broad_phase->find_pairs(world, work.pairs);
  stage.narrow_phase->collide(world, work.pairs, work.contacts);
  stage.contact_model->act(world, work.contacts, {0.0, 0.0}, work.report);
}

}  // namespace epafi
