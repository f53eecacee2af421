#include "detection/shapes/hollow_wall.h"

namespace epafi {

FlatSide HollowSolid::facing(const Vec3& d) const {
  FlatSide side;
  const double across = std::sqrt(d.x() * d.x() + d.y() * d.y()), size = d.norm();
  if (across < facing_sine * size) {
    const bool at_end = d.z() > 0.0;
    const double r = wall.radius_of_end(at_end), z = wall.z_of_end(at_end), q = 0.70710678118654752440 * r;
    if (!(r > 0.0)) return side;
    side.corner = {Vec3(r, 0, z),  Vec3(q, q, z),   Vec3(0, r, z),  Vec3(-q, q, z),
                   Vec3(-r, 0, z), Vec3(-q, -q, z), Vec3(0, -r, z), Vec3(q, -q, z)};
    side.count = 8;
    return side;
  }
  if (std::abs(wall.along_radius * across + wall.along_z * d.z()) > facing_sine * size) return side;
  const double x = d.x() / across, y = d.y() / across;
  for (const bool at_end : {false, true}) {
    const double r = wall.radius_of_end(at_end);
    side.corner[static_cast<std::size_t>(side.count)] = {r * x, r * y, wall.z_of_end(at_end)};
    ++side.count;
  }
  return side;
}

}  // namespace epafi
