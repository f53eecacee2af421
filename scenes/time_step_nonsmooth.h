/// @file time_step_nonsmooth.h  The default time step of a non-smooth scene: the shortest of
///   1/60 s                the longest: a scene of metres at rest or in slow motion
///   sqrt(0.01 d / a)      a body of size d falls by a hundredth of d from rest in a step; a: gravity and a constant
///                         force, or the pressure of a cell on the smallest body
///   d / (4 v)             nothing moves by more than a quarter of the smallest body in a step; v: the largest speed of
///                         the scene, also of walls, or that of a fall from the highest body to the lowest thing below
///   0.1 / w               free bodies other than spheres, and driven ones, rotate by less than 0.1 rad
///   T / 40                period of driven bodies and of bodies on springs (error of velocities (2 pi/40)^2/24 = 1e-3)
///   0.01 / rate           strain rate of a cell
///   output_interval / 10  if a wall or a force follows a table
/// It is at most output_interval (default: a hundredth of the duration) and the shortest interval of a measure, and
/// divides a given output_interval, else the duration.
#pragma once
#include "scenes/assemble.h"

namespace epafi {

TimeStep nonsmooth_step(const Assembly& assembly);

/// The largest step up to `longest` that divides `interval` [s].
double dividing_step(double longest, double interval);

}  // namespace epafi
