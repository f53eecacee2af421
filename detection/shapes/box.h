/// @file box.h  Box about its centre; keeps itself as a polyhedron, so that it shares the algorithms of hulls.
#pragma once
#include "detection/shapes/convex_hull.h"

namespace epafi {

struct Box {
  static constexpr const char* name = "box";
  Vec3 half = Vec3::Zero();  ///< half edge lengths [m], > 0
  ConvexHull hull;  ///< vertex k has the signs of bits 0 (x), 1 (y), 2 (z) of k; face 2i is +axis i, 2i+1 is -axis i

  Box() = default;
  explicit Box(const Vec3& half_extents);

  static Entry entry() {
    return {name, "box about its centre", {{"size", "", "m", Kind::vec3, {}, positive, "edge lengths"}}, {}, ""};
  }

  double bounding_radius() const { return hull.radius; }
  Aabb bounding_box(const Pose& pose) const;
  MassProperties mass_properties() const;
  double contact_radius() const { return hull.equal_volume_radius; }
  Vec3 support(const Vec3& d) const {
    return {d.x() < 0 ? -half.x() : half.x(), d.y() < 0 ? -half.y() : half.y(), d.z() < 0 ? -half.z() : half.z()};
  }
  double rounding() const { return 0.0; }
  PolyhedronView view() const { return hull.view(); }
};
static_assert(SolidShape<Box> && PolyhedralShape<Box>);

}  // namespace epafi
