/// @file few_points.h  A rigid body rests on a surface with four points, of however many parts or walls that consists.
/// Of the points with one normal that touch those remain that keep_four takes (manifold.h): the deepest, and those that
/// span the largest area with it. Of points in one place one remains.
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

/// points: of one body; of equal ones the first is kept. size: of the smaller body [m]; near: closer is one place [m].
/// Marks in `gone`, by contact, those that do not remain; the deepest that remains takes the least gap. True if some
/// went.
bool keep_few(std::span<const SurfacePoint> points, double size, double near, ContactSet& contacts,
              std::vector<std::uint8_t>& gone);

}  // namespace epafi
