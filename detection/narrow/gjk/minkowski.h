/// @file minkowski.h  The Minkowski difference A - B of two convex cores by its support function, in A's axes.
/// Positions enter only as their difference, so the distance from the world's origin costs no digits.
#pragma once
#include <algorithm>

#include "detection/shapes/shape_concept.h"

namespace epafi {

/// A convex core behind one function pointer: one compiled GJK serves all shapes (an indirect call costs 2 ns of 500).
struct ConvexRef {
  const void* shape = nullptr;
  Vec3 (*support_of)(const void*, const Vec3&) = nullptr;
  double radius = 0.0;  ///< of the sphere about the shape's origin that contains the core [m]

  template <ConvexShape S>
  static ConvexRef to(const S& s) {
    return {&s, [](const void* p, const Vec3& d) { return static_cast<const S*>(p)->support(d); },
            s.bounding_radius() - s.rounding()};
  }
  Vec3 support(const Vec3& d) const { return support_of(shape, d); }
};

/// Vertex of the difference with the points it came from, in A's axes, relative to A's centre.
struct MinkowskiVertex {
  Vec3 y, a, b;                            ///< y = a - b [m]
  std::uint32_t index_a = 0, index_b = 0;  ///< of polyhedra: which vertices
};

struct MinkowskiDifference {
  ConvexRef a, b;
  Mat3 rotation;  ///< B's axes to A's axes
  Vec3 offset;    ///< B's centre in A's axes [m]

  MinkowskiDifference(const ConvexRef& shape_a, const ConvexRef& shape_b, const Pose& pose_a, const Pose& pose_b)
      : a(shape_a), b(shape_b) {
    const Mat3 to_a = pose_a.orientation.toRotationMatrix().transpose();
    rotation = to_a * pose_b.orientation.toRotationMatrix();
    offset = to_a * (pose_b.position - pose_a.position);
  }
  MinkowskiDifference(const ConvexRef& shape_a, const ConvexRef& shape_b, const Mat3& b_to_a, const Vec3& centre_b)
      : a(shape_a), b(shape_b), rotation(b_to_a), offset(centre_b) {}
  /// Farthest vertex along d.
  MinkowskiVertex support(const Vec3& d) const {
    const Vec3 on_a = a.support(d);
    const Vec3 on_b = rotation * b.support(-(rotation.transpose() * d)) + offset;
    return {on_a - on_b, on_a, on_b, 0, 0};
  }
  /// Size that tolerances are relative to: the larger of the bodies [m].
  double size() const { return std::max(a.radius, b.radius); }
};

}  // namespace epafi
