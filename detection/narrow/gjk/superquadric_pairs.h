/// @file superquadric_pairs.h  two_normals() for several pairs of superquadrics in SIMD lanes: pair by pair, two thirds
/// of a step are dependent roots and Newton steps.
#pragma once
#include <span>

#include "detection/narrow/gjk/common_normal.h"
#include "detection/shapes/superquadric.h"

namespace epafi {

/// Arguments of two_normals().
struct SuperquadricPair {
  const Superquadric *a, *b;
  Mat3 rotation;  ///< B's axes in A's
  Vec3 offset;    ///< B's centre in A's axes [m]
  double limit;   ///< [m]
};

/// answers[k]: of pairs[k]. The bits are those of two_normals().
void two_normals(std::span<const SuperquadricPair> pairs, std::span<CommonNormal> answers);

}  // namespace epafi
