/// @file expected_fall.h  How far bodies may fall onto what is fixed or driven: to planes that face them, to the faces
/// of boxes that do, and to the bottom of the bounding box of all other walls, which may be hollow. Places beside each
/// other count as if they were below each other.
#pragma once
#include <algorithm>
#include <vector>

#include "scenes/assemble.h"

namespace epafi {

/// Point of the box [low, high] that lies furthest along a direction.
inline Vec3 furthest(const Vec3& low, const Vec3& high, const Vec3& direction) {
  return (direction.array() > 0.0).select(high, low);
}

/// True for wheels and rails on each other.
inline bool touches_rails_only(const Assembly& a, std::uint32_t shape) {
  const auto type = ShapeRef{shape}.type();
  return a.plan.rolling && (type == ShapeStore::type_of<WheelProfile>() || type == ShapeStore::type_of<RailProfile>());
}

inline constexpr double least_steepness = 0.1;  // cosine: bodies fall along steeper walls, not onto them

/// Depth of the lowest corner of the faces that a body meets which moves along the direction [m].
inline double depth_of_faces(const Vec3& centre, const Mat3& half, const Vec3& direction) {
  const Vec3 along = half.transpose() * direction;
  double depth = -infinity;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(along[k]) < least_steepness * half.col(k).norm()) continue;
    const double sides = along.cwiseAbs().sum() - std::abs(along[k]);
    depth = std::max(depth, centre.dot(direction) - std::abs(along[k]) + sides);
  }
  return depth;
}

class ExpectedFall {
 public:
  explicit ExpectedFall(const Assembly& assembly);
  /// From a body's lowest point along a unit direction [m]; 0: nothing is there.
  double height(const Vec3& lowest, const Vec3& direction) const;

 private:
  struct Plane {
    Vec3 point, normal;
  };
  struct PlacedBox {
    Vec3 centre;
    Mat3 half;  ///< columns: half the edges
  };
  std::vector<Plane> planes_;
  std::vector<PlacedBox> boxes_;
  Vec3 low_ = Vec3::Constant(infinity), high_ = Vec3::Constant(-infinity);  ///< of all other walls [m]
};

inline ExpectedFall::ExpectedFall(const Assembly& a) {
  const World& w = a.simulation->world;
  for (Slot s = 0; s < w.size(); ++s) {
    if (w.is_movable(s) || touches_rails_only(a, w.shape[s])) continue;
    const ShapeRef shape{w.shape[s]};
    const Pose pose = w.pose(s);
    if (shape.type() == ShapeStore::type_of<HalfSpace>()) {
      planes_.push_back({pose.position, pose.orientation * a.shapes->of<HalfSpace>()[shape.index()].normal});
    } else if (shape.type() == ShapeStore::type_of<Box>()) {
      const Vec3& half = a.shapes->of<Box>()[shape.index()].half;
      boxes_.push_back({pose.position, pose.orientation.toRotationMatrix() * half.asDiagonal()});
    } else if (std::isfinite(a.shapes->bounding_radius(shape))) {
      const Aabb box = a.shapes->bounding_box(shape, pose);
      low_ = low_.cwiseMin(box.min);
      high_ = high_.cwiseMax(box.max);
    }
  }
}

inline double ExpectedFall::height(const Vec3& lowest, const Vec3& direction) const {
  double height = 0.0;
  for (const Plane& p : planes_) {
    const double steep = -p.normal.dot(direction);
    if (steep > least_steepness) height = std::max(height, p.normal.dot(lowest - p.point) / steep);
  }
  const double start = lowest.dot(direction);
  for (const PlacedBox& b : boxes_) height = std::max(height, depth_of_faces(b.centre, b.half, direction) - start);
  if (low_.allFinite()) height = std::max(height, furthest(low_, high_, direction).dot(direction) - start);
  return height;
}

}  // namespace epafi
