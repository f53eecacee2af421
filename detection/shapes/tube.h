/// @file tube.h  Hollow circular cylinder of no thickness about its centre, axis z; for fixed and driven bodies.
#pragma once
#include "detection/shapes/hollow_wall.h"

namespace epafi {

struct Tube {
  static constexpr const char* name = "tube";
  HollowWall wall;

  Tube(double radius, double length, bool closed) : wall(radius, radius, length, closed) {}

  static Entry entry() {
    return {name,
            "hollow cylinder of no thickness, axis z, a wall from inside and outside; fixed or driven",
            {{"radius", "R", "m", Kind::number, {}, positive, "radius"},
             {"length",
              "L",
              "m",
              Kind::number,
              {},
              positive,
              "length along the axis, half of it on either side of the position"},
             ends_field()},
            {},
            ""};
  }
  static Field ends_field() {
    Field ends{"ends", "", "", Kind::text, Value(std::string("open")), {}, "open, or closed by flat discs"};
    ends.choices = {"open", "closed"};
    return ends;
  }

  double contact_radius() const { return infinity; }
  double bounding_radius() const { return wall.bounding_radius(); }
  Aabb bounding_box(const Pose& pose) const { return wall.bounding_box(pose); }
};
static_assert(HollowShape<Tube>);

}  // namespace epafi
