#include "detection/shapes/box.h"

namespace epafi {

Box::Box(const Vec3& half_extents) : half(half_extents) {
  std::vector<Vec3> corners;
  for (unsigned k = 0; k < 8; ++k) {
    corners.emplace_back(k & 1 ? half.x() : -half.x(), k & 2 ? half.y() : -half.y(), k & 4 ? half.z() : -half.z());
  }
  // Outward counter-clockwise: +x, -x, +y, -y, +z, -z.
  const std::vector<std::vector<std::uint32_t>> faces{{1, 3, 7, 5}, {0, 4, 6, 2}, {2, 6, 7, 3},
                                                      {0, 1, 5, 4}, {4, 5, 7, 6}, {0, 2, 3, 1}};
  hull = ConvexHull::from_faces(std::move(corners), faces).hull;
}

Aabb Box::bounding_box(const Pose& pose) const {
  const Vec3 reach = pose.orientation.toRotationMatrix().cwiseAbs() * half;
  return {pose.position - reach, pose.position + reach};
}

MassProperties Box::mass_properties() const {
  const double mass = 8.0 * half.x() * half.y() * half.z();
  const Vec3 square = half.cwiseProduct(half);
  const Vec3 moments = mass / 3.0 * (Vec3::Constant(square.sum()) - square);  // m/3 (b^2 + c^2) for half lengths
  return {mass, Vec3::Zero(), Mat3(moments.asDiagonal())};
}

}  // namespace epafi
