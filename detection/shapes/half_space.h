/// @file half_space.h  All points x with normal.(x - position) <= 0; for fixed and driven bodies.
#pragma once
#include "detection/shapes/shape_concept.h"

namespace epafi {

struct HalfSpace {
  static constexpr const char* name = "half_space";
  Vec3 normal = Vec3::UnitZ();  ///< outward unit normal in body axes

  static Entry entry() {
    return {name,
            "half space below a plane, fixed or driven",
            {{"normal", "n", "", Kind::vec3, {}, {}, "outward normal"}},
            {},
            ""};
  }

  double contact_radius() const { return infinity; }
  double bounding_radius() const { return infinity; }
  Aabb bounding_box(const Pose&) const { return {Vec3::Constant(-infinity), Vec3::Constant(infinity)}; }
};

}  // namespace epafi
