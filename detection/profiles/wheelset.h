/// @file wheelset.h  Two wheels of one profile on an axle, and their defects. Body axes: origin in the middle of the
/// axle, y along it to the right, z down at the start.
#pragma once
#include <cmath>

#include "detection/profiles/profile.h"
#include "detection/profiles/wheel_rail.h"

namespace epafi {

/// Deviations of a wheel from a circle. A new flat is a chord: the wheel rotates about its edges, so that the axle is
/// lower by R (1 - cos(half the flat's angle - angle of its middle from the rail)).
struct WheelDefect {
  double flat_length = 0.0;        ///< l [m], >= 0
  double flat_angle = 0.0;         ///< rolling angle at which the middle of the flat is at the bottom [rad]
  double amplitude = 0.0;          ///< of out-of-round a sin(n theta) [m]
  int order = 1;                   ///< n, >= 1
  bool left = true, right = true;  ///< which wheels have it

  bool any() const { return flat_length > 0.0 || amplitude != 0.0; }
  /// Lowering of the axle over a level rail with the wheel rotated by `angle` [rad] from the start [m].
  double drop(double angle, double radius) const;
  /// Its derivative by the angle [m]: distance of the contact point behind the axle.
  double offset(double angle, double radius) const;
};

struct Wheelset {
  Profile wheel;
  TrackGeometry geometry;  ///< radius, flange_back, tape_circle
  WheelDefect defect;
  double mass = 0.0;            ///< [kg]
  Vec3 inertia = Vec3::Zero();  ///< about x, y, z of the body [kg m^2]

  double half_width() const { return 0.5 * geometry.flange_back + geometry.tape_circle + wheel.y_max(); }
  double largest_radius() const { return geometry.radius + 0.04; }  // flanges are 28 to 36 mm high
};

}  // namespace epafi
