/// @file hollow_wall.h  The surface of a hollow body of revolution with a straight side, for tube and cone. It has no
/// thickness: bodies touch it from inside and from outside. The axis is the body's own z, the origin half way between
/// start (z = -h) and end (z = h); each end is open, or closed by a flat disc.
#pragma once
#include <algorithm>
#include <cmath>
#include <concepts>

#include "detection/shapes/flat_side.h"
#include "detection/shapes/shape_concept.h"

namespace epafi {

struct HollowWall {
  double start_radius, end_radius;  ///< at z = -h and z = h [m], >= 0, one of them > 0
  double half_length;               ///< h [m], > 0
  bool closed;                      ///< both ends are discs

  double side_length;            ///< of the side from start to end [m]
  double along_radius, along_z;  ///< unit vector of the side from start to end, in the half plane of radius and z

  HollowWall(double start, double end, double length, bool is_closed)
      : start_radius(start), end_radius(end), half_length(0.5 * length), closed(is_closed) {
    side_length = std::sqrt((end - start) * (end - start) + length * length);
    along_radius = (end - start) / side_length;
    along_z = length / side_length;
  }

  double most_radius() const { return std::max(start_radius, end_radius); }
  double bounding_radius() const { return std::sqrt(half_length * half_length + most_radius() * most_radius()); }
  /// Exact bounding box of the two end circles: a circle of radius r normal to u extends r sqrt(1 - u_i^2) along axis
  /// i.
  Aabb bounding_box(const Pose& pose) const {
    const Mat3 turn = pose.orientation.toRotationMatrix();
    const Vec3 reach = turn.leftCols<2>().rowwise().norm(), axis = half_length * turn.col(2);
    const Vec3 start = pose.position - axis, end = pose.position + axis;
    return {(start - start_radius * reach).cwiseMin(end - end_radius * reach),
            (start + start_radius * reach).cwiseMax(end + end_radius * reach)};
  }

  /// Signed distance of a point of the half plane from the infinite line of the side: positive outside [m].
  double beyond_side(double radius, double z) const {
    return along_z * (radius - start_radius) - along_radius * (z + half_length);
  }
  /// Along the side from its start to the foot of that point [m].
  double way_along(double radius, double z) const {
    return along_radius * (radius - start_radius) + along_z * (z + half_length);
  }
  double radius_at(double way) const { return start_radius + along_radius * way; }
  double radius_of_end(bool at_end) const { return at_end ? end_radius : start_radius; }
  double z_of_end(bool at_end) const { return at_end ? half_length : -half_length; }

  /// From the nearest point of the surface to a point in body axes [m].
  double distance(const Vec3& x) const {
    const double radius = std::sqrt(x.x() * x.x() + x.y() * x.y());
    const double way = std::clamp(way_along(radius, x.z()), 0.0, side_length);
    const double across = radius - radius_at(way), up = x.z() - (along_z * way - half_length);
    double least = across * across + up * up;
    for (const bool at_end : {false, true}) {
      if (!closed) break;
      const double out = std::max(0.0, radius - radius_of_end(at_end)), over = x.z() - z_of_end(at_end);
      least = std::min(least, out * out + over * over);
    }
    return std::sqrt(least);
  }
};

/// A wall that is such a surface.
template <class S>
concept HollowShape = requires(const S& s) {
  { s.wall } -> std::convertible_to<const HollowWall&>;
};

/// The solid that the surface encloses, for bodies outside.
struct HollowSolid {
  HollowWall wall;

  double bounding_radius() const { return wall.bounding_radius(); }
  double contact_radius() const { return infinity; }
  double rounding() const { return 0.0; }
  /// A point of that rim which is further along d.
  Vec3 support(const Vec3& d) const {
    const double across = std::sqrt(d.x() * d.x() + d.y() * d.y());
    const bool at_end =
        wall.end_radius * across + d.z() * wall.half_length > wall.start_radius * across - d.z() * wall.half_length;
    const double r = wall.radius_of_end(at_end), z = wall.z_of_end(at_end);
    if (!(across > 0.0)) return {0.0, 0.0, z};
    return {r * (d.x() / across), r * (d.y() / across), z};
  }
  /// Eight points of the rim of the end on the side of d, or the line of the side.
  FlatSide facing(const Vec3& d) const;
};
static_assert(ConvexShape<HollowSolid>);

}  // namespace epafi
