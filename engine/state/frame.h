/// @file frame.h  Contact frame (n, t1, t2) from a unit normal, without branches (Duff et al. 2017).
#pragma once
#include <cmath>

#include "engine/state/types.h"

namespace epafi {

struct ContactFrame {
  Vec3 normal, tangent1, tangent2;
  ContactFrame() {}  // unset, as vectors are: columns are first written by all threads, not cleared by one
  ContactFrame(const Vec3& n, const Vec3& t1, const Vec3& t2) : normal(n), tangent1(t1), tangent2(t2) {}
};

/// Right-handed orthonormal frame; n must be a unit vector. Continuous except across n.z = 0.
inline ContactFrame contact_frame(const Vec3& n) {
  const double sign = std::copysign(1.0, n.z());
  const double a = -1.0 / (sign + n.z());
  const double b = n.x() * n.y() * a;
  return {n, Vec3(1.0 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()), Vec3(b, sign + n.y() * n.y() * a, -n.y())};
}

}  // namespace epafi
