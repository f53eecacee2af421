/// @file sphere_union.h  Volume, centre and inertia of a union of balls, each part of space counted once.
/// Level cuts are unions of discs, whose moments follow from their outer arcs (Green); along z the cuts are integrated
/// between the heights where their shape changes (poles, ends of the circles in which two balls meet, points common to
/// three), with 24 Gauss points that a sine crowds towards both ends, where cuts go like square roots. 1e-10 of the
/// whole.
#pragma once
#include <span>
#include <vector>

#include "detection/shapes/shape_concept.h"

namespace epafi {

struct PlacedBall {
  Vec3 centre;          ///< [m]
  double radius = 0.0;  ///< [m], > 0
};

/// At density 1; inertia about the centre. Cost grows with the cube of the number of balls that meet at one place.
[[nodiscard]] MassProperties union_mass_properties(std::span<const PlacedBall> balls);

/// Nodes and weights of Gauss and Legendre on [-1, 1].
struct GaussRule {
  std::vector<double> node, weight;
};
[[nodiscard]] GaussRule gauss_rule(int points);

}  // namespace epafi
