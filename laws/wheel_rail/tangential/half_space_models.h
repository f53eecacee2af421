/// @file half_space_models.h  Half-space tractions as tangential models: steady rolling, a start from rest, a shift.
#pragma once
#include "laws/wheel_rail/tangential_models.h"

namespace epafi {

/// `saturation`: linear force of the creepages over mu N, of which the solver's tolerance is a share where it is small.
TangentialOutcome steady_half_space(const TangentialInput& in, double saturation);
/// Rolled over in.distance from rest.
TangentialOutcome starting_half_space(const TangentialInput& in);
/// The bodies displaced by creepage times in.distance, pressed on but not rolling.
TangentialOutcome shifted_half_space(const TangentialInput& in);

}  // namespace epafi
