/// @file load_poles.h  Times at which a load that follows time leaves all measure: an expression may divide by zero
/// between two steps, and no step sees more of it than a large number.
#pragma once
#include "scenes/assemble.h"

namespace epafi {

/// A time in [from, until] [s] at which |f| has no bound, or is no number: where the sign changes or |f| has a peak
/// among `samples`, the place is closed in to rounding, and |f| there is a million times that beside it. None where f
/// is bounded, jumps included.
std::optional<double> find_pole(const std::function<double(double)>& f, double from, double until,
                                std::size_t samples = 4096);

/// Throws SceneError where gravity, a force or a torque of the scene has one while the stage lasts.
void check_loads(const Assembly& assembly);

}  // namespace epafi
