/// @file placed_hull.h  A polyhedron in its own principal axes, and where these lie in the author's.
#pragma once
#include "detection/mass_properties.h"
#include "detection/shapes/convex_hull.h"
#include "detection/shapes/hull_from_points.h"

namespace epafi {

/// frame.orientation turns the hull's axes into the author's: a body with the author's orientation q has q *
/// frame.orientation.
struct PlacedHull {
  ConvexHull hull;
  PrincipalFrame frame;
};

/// Hull of points in the author's axes; `sweep`: radius of the sphere swept over it [m], >= 0. Throws SceneError at
/// `place`.
[[nodiscard]] PlacedHull place_hull(std::span<const Vec3> points, double sweep = 0.0, const Place& place = {});

}  // namespace epafi
