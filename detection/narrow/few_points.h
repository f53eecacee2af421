/// @file few_points.h  Selects the contact points of a rigid body on a surface of several parts or walls. Smooth laws:
/// the corners of its convex hull that lie below the surface, if all of them touch it; they stay the same as the body
/// rotates, so their springs have a potential. Else, of touching points with one normal, those of keep_four
/// (manifold.h): the deepest, and those that span the largest area with it. Of coincident points one is kept.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/state/contacts.h"

namespace epafi {

/// The points of a face have one normal to rounding; those of two faces of a body differ by more.
inline bool same_direction(const Vec3& n, const Vec3& m) { return n.dot(m) > 1.0 - 1e-9; }

/// A contact as the body sees it.
struct SurfacePoint {
  std::size_t contact;
  Vec3 place;   ///< from the body's centre [m]
  Vec3 normal;  ///< unit, out of the wall
};

/// Corners of the convex outline of one of the two bodies, from the centre of the body of the points, world axes.
struct OutlineCorners {
  std::vector<Vec3> corners;
  double sweep = 0.0;  ///< radius of the sphere swept over it [m]
  double side = 1.0;   ///< -1: of the wall
};

/// points: of one body; of equal ones the first is kept. outlines: of the two bodies; none where no springs act or a
/// body has no corners. size: of the smaller body [m]; near: closer is one place [m]. Marks in `gone`, by contact,
/// those that do not remain; the deepest that remains takes the least gap. True if some went.
bool keep_few(std::span<const SurfacePoint> points, std::span<const OutlineCorners> outlines, double size, double near,
              ContactSet& contacts, std::vector<std::uint8_t>& gone);

}  // namespace epafi
