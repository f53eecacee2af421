/// @file time_step.h  The time step of a scene: as written, or "auto" with the reason.
#pragma once
#include "scenes/assemble.h"

namespace epafi {

/// smooth: auto = 0.1 of the shortest contact time estimate; non-smooth: the smaller of output_interval / 10 and
/// sqrt(0.01 d / g), d the smallest free body's diameter. Throws SceneError where a written step exceeds the limit.
TimeStep choose_time_step(const Assembly& assembly);

}  // namespace epafi
