/// @file clump.h  Rigid cluster of balls, overlapping or not: each ball touches on its own.
/// Body axes: origin at the centre of mass, axes principal. Mass properties are those of the union (sphere_union.h).
#pragma once
#include <vector>

#include "detection/shapes/sphere.h"
#include "detection/shapes/sphere_union.h"

namespace epafi {

struct Clump {
  static constexpr const char* name = "clump";
  static constexpr std::size_t most_parts = 256;  ///< the number of a part stands in eight bits of a contact's feature
  std::vector<PlacedBall> parts;                  ///< body axes

  static Entry entry() {
    Field given{"mass", "m", "kg", Kind::number, {}, positive, "mass; default: that of the union of the balls"};
    Field moments{"inertia", "I", "kg m^2", Kind::vec3, {}, positive, "moments about the author's axes, with mass"};
    Field centre{"centre", "", "m", Kind::vec3, {}, {}, "centre of mass, with mass"};
    given.optional = moments.optional = centre.optional = true;
    return {name,
            "rigid cluster of balls",
            {{"spheres", "", "m", Kind::quadruples, {}, any_number, "balls [x, y, z, radius]"}, given, moments, centre},
            {},
            ""};
  }

  using Part = Sphere;
  std::size_t part_count() const { return parts.size(); }
  Sphere part(std::size_t k) const { return {parts[k].radius}; }
  Pose part_pose(std::size_t k, const Pose& pose) const { return {pose.to_world(parts[k].centre), pose.orientation}; }

  double bounding_radius() const {
    double r = 0.0;
    for (const PlacedBall& p : parts) r = std::max(r, p.centre.norm() + p.radius);
    return r;
  }
  double contact_radius() const { return parts.front().radius; }
  Aabb bounding_box(const Pose& pose) const {
    Aabb box{Vec3::Constant(infinity), Vec3::Constant(-infinity)};
    for (const PlacedBall& p : parts) {
      const Vec3 x = pose.to_world(p.centre), r = Vec3::Constant(p.radius);
      box.min = box.min.cwiseMin(x - r);
      box.max = box.max.cwiseMax(x + r);
    }
    return box;
  }
  MassProperties mass_properties() const { return union_mass_properties(parts); }
};
static_assert(SolidShape<Clump>);

}  // namespace epafi
