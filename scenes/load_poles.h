/// @file load_poles.h  Poles of time-dependent loads: an expression may divide by zero between two steps, where steps
/// see only large numbers.
#pragma once
#include "scenes/assemble.h"

namespace epafi {

/// A time in [from, until] [s] at which f is unbounded or not finite: sign changes and peaks of |f| among `samples` are
/// bisected to rounding, and |f| there exceeds its neighbourhood a million times. None for bounded f, jumps included.
std::optional<double> find_pole(const std::function<double(double)>& f, double from, double until,
                                std::size_t samples = 4096);

/// Throws SceneError where gravity, a force or a torque of the scene has one while the stage lasts.
void check_loads(const Assembly& assembly);

}  // namespace epafi
