/// @file polyhedra.h  Two convex polyhedra, exact by features: signed distance and common normal.
/// Separated: GJK, whose final simplex names the features that the distance is then taken from. Overlapping:
/// separating-axis test over faces and over the edge pairs whose Gauss arcs cross (Gregorius 2013), pruned by inner
/// spheres. The normal is that of a face, of two edges or of two vertices, never a difference of nearly equal points.
#pragma once
#include "detection/narrow/gjk/gjk.h"
#include "detection/narrow/polyhedra/pair_memory.h"
#include "detection/shapes/convex_hull.h"

namespace epafi {

/// A polyhedron as argument of GJK and EPA; the view must outlive it.
inline ConvexRef core_of(const PolyhedronView& view) {
  const auto support = [](const void* p, const Vec3& d) {
    const auto& v = *static_cast<const PolyhedronView*>(p);
    return v.vertices[ConvexHull::support_vertex(v, d)];
  };
  return {&view, support, view.radius};
}

/// B is placed in A's axes, so results do not depend on the distance from the origin.
struct PolyhedronPair {
  PolyhedronView a, b;
  Mat3 rotation;  ///< B's axes to A's axes
  Vec3 offset;    ///< B's centre in A's axes [m]

  PolyhedronPair(const PolyhedronView& view_a, const PolyhedronView& view_b, const Pose& pose_a, const Pose& pose_b);
  Vec3 vertex_b(std::uint32_t v) const { return rotation * b.vertices[v] + offset; }
  std::uint32_t support_a(const Vec3& n) const { return ConvexHull::support_vertex(a, n); }
  std::uint32_t support_b(const Vec3& n) const { return ConvexHull::support_vertex(b, -(rotation.transpose() * n)); }
  /// Signed distance along the unit direction n (A to B): min over B of n.x minus max over A. A lower bound of the
  /// distance.
  double separation(const Vec3& n) const { return n.dot(vertex_b(support_b(n)) - a.vertices[support_a(n)]); }
  double size() const { return std::max(a.radius, b.radius); }
};

/// The direction of largest signed distance and the features it belongs to.
struct SeparatingAxis {
  enum class Kind { none, points, face_a, face_b, edges };
  Kind kind = Kind::none;
  double gap = -infinity;       ///< signed distance along `normal` [m]
  Vec3 normal = Vec3::UnitZ();  ///< unit, A to B, A's axes
  std::uint32_t feature_a = 0;  ///< face of A, edge of A (kind edges), deepest vertex of A (kind face_b)
  std::uint32_t feature_b = 0;  ///< face of B, edge of B (kind edges), deepest vertex of B (kind face_a)
};

/// Largest separation over faces and edge pairs. start: an earlier axis; makes the search faster, with the same bits.
SeparatingAxis separating_axis(const PolyhedronPair& pair, const SeparatingAxis& start = {});

/// Signed distance of two polyhedra with closest (deepest) points.
struct PolyhedronDistance {
  SeparatingAxis axis;
  Vec3 witness_a, witness_b;  ///< A's axes, relative to A's centre; witness_b - witness_a = gap normal [m]
  bool beyond = false;        ///< gap > limit: nothing but axis.gap (a lower bound) and axis.normal is known
  double uncertainty = 0.0;   ///< the distance lies in [gap, gap + uncertainty] [m]
};

/// The axis of largest separation with its points: exact while the bodies overlap, a lower bound of the distance
/// otherwise.
PolyhedronDistance axis_distance(const PolyhedronPair& pair);

/// limit: larger distances need not be computed [m]. memory: of this pair, from earlier poses; bits are the same
/// without it.
PolyhedronDistance polyhedron_distance(const PolyhedronPair& pair, double limit = infinity,
                                       PairMemory* memory = nullptr);

}  // namespace epafi
