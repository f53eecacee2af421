/// @file half_space_models.h  Half-space tractions as tangential models: steady rolling, a start from rest, a shift.
#pragma once
#include "laws/wheel_rail/tangential_models.h"

namespace epafi {

TangentialOutcome steady_half_space(const TangentialInput& in);
/// Rolled over in.distance from rest.
TangentialOutcome starting_half_space(const TangentialInput& in);
/// The bodies displaced by creepage times in.distance, pressed on but not rolling.
TangentialOutcome shifted_half_space(const TangentialInput& in);

}  // namespace epafi
