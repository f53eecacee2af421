/// @file common_normal.h  Signed distance of two round cores by Newton's method on their common normal.
/// Along a unit vector n from A to B the gap of the cores is g(n) = -n . y(n), where y(n) is the support point of the
/// difference A - B; the signed distance is its largest value. There y is parallel to n: the points that carry it have
/// one normal (Johnson 1985, section 4.1). Two facts make the answer certain:
/// * apart (g > 0), every n gives a lower bound, so that the largest value found is the distance;
/// * overlapping, A - B has no radius of curvature below r, the sum of the least radii of A and B, so that a ball of
///   radius r rolls freely inside it (Blaschke 1956): where the common normal has depth -g < r it is the least depth.
/// Where a body has flat sides the steps are those of two_normals.h.
/// Otherwise the caller uses the exact method. There is no memory, so the result depends only on the poses.
#pragma once
#include <cmath>

#include "detection/narrow/gjk/minkowski.h"

namespace epafi {

/// A core that is round: curved_support(d) at a unit d in body axes; its semi-axes [m] (any enclosing ones, the search
/// begins by them); the least radius of curvature anywhere [m], 0 for a point; whether it is curved everywhere, so that
/// contact laws may take its curvature.
template <class S>
concept RoundShape = ConvexShape<S> && requires(const S& s, const Vec3& d) {
  { s.curved_support(d) } -> std::same_as<CurvedSupport>;
  { s.core_semi_axes() } -> std::same_as<Vec3>;
  { s.least_radius() } -> std::same_as<double>;
  { s.curved() } -> std::same_as<bool>;
  { s.contact_radius() } -> std::same_as<double>;
};

/// A round core behind one function pointer.
struct RoundRef {
  const void* shape;
  CurvedSupport (*curved_support_of)(const void*, const Vec3&);
  /// The unit direction that a step leads to from one with this support, where the shape has flat sides; else null.
  Vec3 (*turned_of)(const void*, const Vec3& d, const CurvedSupport& at, const Vec3& step);
  Vec3 semi_axes;
  double least_radius;
  bool curved;
  double contact_radius;  ///< radius for R* of a shape that is flat somewhere [m]

  template <RoundShape S>
  static RoundRef to(const S& s) {
    return {&s,
            [](const void* p, const Vec3& d) { return static_cast<const S*>(p)->curved_support(d); },
            turned_on<S>(),
            s.core_semi_axes(),
            s.least_radius(),
            s.curved(),
            s.contact_radius()};
  }

 private:
  template <RoundShape S>
  static constexpr auto turned_on() -> Vec3 (*)(const void*, const Vec3&, const CurvedSupport&, const Vec3&) {
    if constexpr (requires(const S& s, const Vec3& d, const CurvedSupport& at) { s.turned(d, at, d); })
      return [](const void* p, const Vec3& d, const CurvedSupport& at, const Vec3& step) {
        return static_cast<const S*>(p)->turned(d, at, step);
      };
    else
      return nullptr;
  }
};

/// Two unit vectors that complete the unit vector n (Duff et al. 2017).
struct Tangents {
  Vec3 u, v;
  explicit Tangents(const Vec3& n) {
    const double sign = n.z() < 0.0 ? -1.0 : 1.0;
    const double a = -1.0 / (sign + n.z()), b = n.x() * n.y() * a;
    u = {1.0 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()};
    v = {b, sign + n.y() * n.y() * a, -n.y()};
  }
};

/// Nearest or deepest points of two cores, in A's axes, relative to A's centre.
struct CommonNormal {
  enum class Status {
    found,     ///< gap, normal and points are those of the signed distance
    beyond,    ///< the gap exceeds the limit: the normal certifies it, nothing else is known
    uncertain  ///< overlap too deep to be certain, or no convergence: use the exact method
  };
  Status status = Status::uncertain;
  double gap = 0.0;                               ///< [m], negative where the cores overlap
  Vec3 normal = Vec3::UnitZ();                    ///< unit, from A to B
  Vec3 on_a = Vec3::Zero(), on_b = Vec3::Zero();  ///< the points of the cores [m]
  int iterations = 0;
};

/// The normal of two similar ellipsoids, (A^2 + B^2)^-1 c, c the way from centre to centre; exact for two spheres.
Vec3 first_normal(const RoundRef& a, const RoundRef& b, const Mat3& rotation, const Vec3& offset);

/// rotation, offset: B's axes and centre in A's. limit: gaps beyond are not wanted [m].
CommonNormal common_normal(const RoundRef& a, const RoundRef& b, const Mat3& rotation, const Vec3& offset,
                           double limit);

}  // namespace epafi
