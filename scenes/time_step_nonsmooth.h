/// @file time_step_nonsmooth.h  The default time step of a non-smooth scene: the shortest of
///   1/60 s              the longest: a scene of metres at rest or in slow motion
///   sqrt(0.01 d / a)    a body of size d falls a hundredth of it from rest in a step; a: gravity and a constant force,
///                       or the pressure of a cell on the smallest body
///   d / (4 v)           nothing moves further than a quarter of the smallest body in a step; v: the largest speed
///                       that is written, of walls too, or of the fall from the highest body to the lowest thing below
///                       it
///   0.1 / w             free bodies other than spheres, and driven ones, turn by less than 0.1 rad
///   T / 40              period of driven bodies and of bodies on springs (error of velocities (2 pi/40)^2/24 = 1e-3)
///   0.01 / rate         of a cell that is strained output_interval / 10 where a wall or a force follows a table
/// Never longer than output_interval (a hundredth of the duration where that is not written) or the shortest interval
/// of a measure. It divides a written output_interval, else the duration.
#pragma once
#include "scenes/assemble.h"

namespace epafi {

TimeStep nonsmooth_step(const Assembly& assembly);

/// The largest step up to `longest` that divides `interval` [s].
double dividing_step(double longest, double interval);

}  // namespace epafi
