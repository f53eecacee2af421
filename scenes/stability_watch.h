/// @file stability_watch.h  The watch over the time step of smooth contact: with all contacts and springs of the
/// moment.
#pragma once
#include <functional>
#include <memory>

#include "scenes/assemble.h"

namespace epafi {

/// Divides a step that the program has chosen, ends a run whose written step is unstable. Null under non-smooth contact
/// and where the scene allows an unstable step.
std::unique_ptr<StepWatch> make_stability_watch(const Assembly& assembly);

/// Function that computes stiffness_bound (engine/step/stiffest_mode.h) for a part of the bodies; empty where not only
/// their contacts count.
std::function<double(const World&, const ContactPieces&, double dt)> stiffness_of_parts(const Assembly& assembly);

/// The largest step that all contacts and springs of this moment allow [s]; infinite where there are none.
double stable_step_now(const Assembly& assembly);

}  // namespace epafi
