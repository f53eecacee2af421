/// @file oriented_box.h  Box in any orientation, and whether two of them meet.
#pragma once
#include <cmath>

#include "detection/aabb.h"

namespace epafi {

struct OrientedBox {
  Vec3 centre = Vec3::Zero();
  Mat3 axes = Mat3::Identity();  ///< columns: unit directions of the sides
  Vec3 half = Vec3::Zero();      ///< half lengths of the sides [m]

  /// The box of a body's own axes, placed at `pose` and grown by `margin` [m] on every side.
  static OrientedBox placed(const Aabb& own, const Pose& pose, double margin) {
    return {pose.to_world(own.centre()), pose.orientation.toRotationMatrix(),
            0.5 * own.extent() + Vec3::Constant(margin)};
  }
};

/// False only where one of the 15 axes of two boxes separates them by more than rounding (Gottschalk, Lin and Manocha
/// 1996): never false for boxes that meet.
inline bool overlap(const OrientedBox& a, const OrientedBox& b) {
  const Mat3 turn = a.axes.transpose() * b.axes;
  const Vec3 t = a.axes.transpose() * (b.centre - a.centre);
  // A cross product of nearly equal sides is rounding alone: what is added keeps it from separating.
  const Mat3 size = (turn.cwiseAbs().array() + 1e-12).matrix();
  if (((t.cwiseAbs() - a.half - size * b.half).array() > 0.0).any()) return false;
  if ((((turn.transpose() * t).cwiseAbs() - b.half - size.transpose() * a.half).array() > 0.0).any()) return false;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const double reach =
          a.half[i1] * size(i2, j) + a.half[i2] * size(i1, j) + b.half[j1] * size(i, j2) + b.half[j2] * size(i, j1);
      if (std::abs(t[i2] * turn(i1, j) - t[i1] * turn(i2, j)) > reach) return false;
    }
  }
  return true;
}

}  // namespace epafi
