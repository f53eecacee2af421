/// @file rotation.h  Torque-free motion of a rigid body over one step, by symmetric splitting of the kinetic energy
/// (McLachlan 1993; Dullweber, Leimkuhler and McLachlan 1997). The angular momentum in space is kept exactly, the
/// energy error is bounded and of second order; for symmetric tops (two equal moments) the motion is exact.
#pragma once
#include <array>

#include "engine/state/types.h"

namespace epafi {

/// sin and cos with + - * / only, so that no libm can change a bit. Reduction in two parts: |x| up to 1e5, error below
/// 2 ulp.
struct SinCos {
  double sin, cos;
};
SinCos sin_cos(double x);

/// Advances the orientation q (body to world) by dt without torque. The angular momentum in space [kg m^2/s] is the
/// state that stays: not a bit of it changes. inverse_inertia: principal [1/(kg m^2)], each > 0.
void rotate_freely(Quat& q, const Vec3& angular_momentum, const Vec3& inverse_inertia, double dt);

/// q turned by the rotation vector `angle` (world axes) [rad], of any length.
Quat turned_far(const Quat& q, const Vec3& angle);

/// The same. Below 0.02 rad, where a step of a stable simulation lies, the series of sin(h)/h and cos(h) end below
/// 1e-21 after three terms: a sixth of the time of sin_cos.
inline Quat turned(const Quat& q, const Vec3& angle) {
  const double square = angle.squaredNorm();
  if (!(square < 4e-4)) return turned_far(q, angle);
  const double h = 0.25 * square;  // square of half the angle
  const double half_sinc = 0.5 - h * (1.0 / 12 - h * (1.0 / 240 - h * (1.0 / 10080)));
  const double c = 1.0 - h * (0.5 - h * (1.0 / 24 - h * (1.0 / 720)));
  const double x = half_sinc * angle.x(), y = half_sinc * angle.y(), z = half_sinc * angle.z();
  const double w = c * q.w() - x * q.x() - y * q.y() - z * q.z(), i = c * q.x() + x * q.w() + y * q.z() - z * q.y();
  const double j = c * q.y() + y * q.w() + z * q.x() - x * q.z(), k = c * q.z() + z * q.w() + x * q.y() - y * q.x();
  const double unit =
      1.5 - 0.5 * (w * w + i * i + j * j + k * k);  // the length differs from 1 by rounding: one Newton step
  return Quat(unit * w, unit * i, unit * j, unit * k);
}

}  // namespace epafi
