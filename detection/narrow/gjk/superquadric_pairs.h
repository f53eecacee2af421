/// @file superquadric_pairs.h  two_normals() of pairs of superquadrics, as many at a time as a register has numbers:
/// two thirds of a step of superquadrics, pair by pair, are roots and steps that wait for each other.
#pragma once
#include <span>

#include "detection/narrow/gjk/common_normal.h"
#include "detection/shapes/superquadric.h"

namespace epafi {

/// What two_normals() is asked.
struct SuperquadricPair {
  const Superquadric *a, *b;
  Mat3 rotation;  ///< B's axes in A's
  Vec3 offset;    ///< B's centre in A's axes [m]
  double limit;   ///< [m]
};

/// answers[k]: of pairs[k]. The bits are those of two_normals().
void two_normals(std::span<const SuperquadricPair> pairs, std::span<CommonNormal> answers);

}  // namespace epafi
