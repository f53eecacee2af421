/// @file rotation.h  Torque-free motion of a rigid body over one step, by symmetric splitting of the kinetic energy
/// (McLachlan 1993; Dullweber, Leimkuhler and McLachlan 1997). The angular momentum in space is kept exactly, the
/// energy error is bounded and of second order; for symmetric tops (two equal moments) the motion is exact.
#pragma once
#include <array>

#include "engine/types.h"

namespace epafi {

/// sin and cos with + - * / only, so that no libm can change a bit. Reduction in two parts: |x| up to 1e5, error below 2 ulp.
struct SinCos {
  double sin, cos;
};
SinCos sin_cos(double x);

/// Advances the orientation q (body to world) by dt without torque. The angular momentum in space [kg m^2/s] is the
/// state that stays: not a bit of it changes. inverse_inertia: principal [1/(kg m^2)], each > 0.
void rotate_freely(Quat& q, const Vec3& angular_momentum, const Vec3& inverse_inertia, double dt);

/// q turned by the rotation vector `angle` (world axes) [rad].
Quat turned(const Quat& q, const Vec3& angle);

}  // namespace epafi
