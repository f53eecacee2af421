/// @file cone.h  Hollow truncated cone of no thickness, axis z; for fixed and driven bodies.
#pragma once
#include "detection/shapes/tube.h"

namespace epafi {

struct Cone {
  static constexpr const char* name = "cone";
  HollowWall wall;

  Cone(double start_radius, double end_radius, double length, bool closed)
      : wall(start_radius, end_radius, length, closed) {}

  static Entry entry() {
    return {
        name,
        "hollow cone, whole or truncated, of no thickness, axis z, a wall from inside and outside; fixed or driven",
        {{"radii",
          "R",
          "m",
          Kind::numbers,
          {},
          not_negative,
          "radii at its start and at its end, [start, end]; one may be 0"},
         {"length", "L", "m", Kind::number, {}, positive, "length along the axis: start at z = -L/2, end at z = L/2"},
         Tube::ends_field()},
        {},
        ""};
  }

  double contact_radius() const { return infinity; }
  double bounding_radius() const { return wall.bounding_radius(); }
  Aabb bounding_box(const Pose& pose) const { return wall.bounding_box(pose); }
};
static_assert(HollowShape<Cone>);

}  // namespace epafi
