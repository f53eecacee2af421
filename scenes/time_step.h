/// @file time_step.h  The time step of a scene: as written, or "auto" with the reason.
#pragma once
#include "scenes/assemble.h"

namespace epafi {

/// smooth: auto = 0.1 of the shortest contact time estimate; non-smooth: time_step_nonsmooth.h. Throws SceneError where
/// a written step exceeds the limit.
TimeStep choose_time_step(const Assembly& assembly);

/// Equal parts of an adaptive step of dt [s] in which no body moves by more than a tenth of its radius: contacts that
/// overlap by less than 0.3 of it are resolved without.
int parts_by_motion(const World& world, const ShapeStore& shapes, double dt);

/// For `epafi explain`: the time step and why, and of non-smooth contact the solver and the law of impact.
std::string chosen_text(const Assembly& assembly);

/// Advice against an overlap of this share of the smaller radius: "; 3.2e+02 times the stiffness ...".
std::string overlap_remedy(double relative, bool smooth);

}  // namespace epafi
