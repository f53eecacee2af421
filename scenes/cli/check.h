/// @file check.h  `epafi check`: properties of a run, without running it.
#pragma once
#include <string>

#include "scenes/stage_check.h"

namespace epafi {

/// Bodies, geometry, overlaps at t = 0, time step and its limit, steps, memory, estimated processor time. Runs one
/// detection and a few timed steps on the assembled scene, which is used up; writes nothing.
std::string check_text(Assembly& assembly, const std::vector<StageCheck>& stages);

}  // namespace epafi
