/// @file step.h  The time step, the same for smooth and non-smooth mechanics.
#pragma once
#include "engine/step/pipeline.h"

namespace epafi {

/// Data of a step for observers and for the next step.
struct Workspace {
  PairList pairs;
  ContactSet contacts;
  StepReport report;
};

/// Advances the world by one step: integrate, find pairs, find contacts, let them act, integrate. run_on: as
/// StepClock::run_on. timer: measures the stages from its last lap on. begun: bodies have other slots since a contact
/// model did the first half; forces are those of the last step.
void step(World& world, Pipeline& stage, Workspace& work, double dt, StageTimer& timer, const RunOn* run_on = nullptr,
          bool begun = false);
void step(World& world, Pipeline& stage, Workspace& work, double dt);

/// Evaluates the contact forces of the present state, without moving anything.
void evaluate_forces(World& world, Pipeline& stage, Workspace& work);

}  // namespace epafi
