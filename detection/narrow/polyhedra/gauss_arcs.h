/// @file gauss_arcs.h  Edges of two polyhedra as arcs on the Gauss sphere, and the best axis among those tried.
/// An edge of A and one of B span a facet of the Minkowski difference exactly where their arcs cross (Gregorius 2013).
#pragma once
#include "detection/narrow/polyhedra/polyhedra.h"

namespace epafi {

/// An edge whose arc on the Gauss sphere may hold the best axis. All in A's axes; B's normals are negated.
struct ArcEdge {
  Vec3 direction, left, right;
  std::uint32_t index;
};

ArcEdge arc_of_a(const PolyhedronPair& pair, std::uint32_t edge);
ArcEdge arc_of_b(const PolyhedronPair& pair, std::uint32_t edge);

/// The two arcs cross.
inline bool arcs_cross(const ArcEdge& a, const ArcEdge& b) {
  const double left_b = a.direction.dot(b.left), right_b = a.direction.dot(b.right);
  if (left_b * right_b >= 0.0) return false;
  const double left_a = b.direction.dot(a.left), right_a = b.direction.dot(a.right);
  return left_a * right_a < 0.0 && left_b * right_a > 0.0;
}
/// They cross or may do so after turning one body by up to `turn` [rad].
bool arcs_may_cross(const ArcEdge& a, const ArcEdge& b, double turn);

/// The best axis of those tried, whatever their order: equal ones are told apart by kind and index, and an edge pair
/// must be better than faces by more than rounding.
class AxisCandidates {
 public:
  explicit AxisCandidates(const PolyhedronPair& pair);
  /// v: the vertex of the other body deepest below the face.
  double try_face_a(std::uint32_t f, std::uint32_t v);
  double try_face_b(std::uint32_t f, std::uint32_t v);
  /// Tests a pair of edges; gaps below the floor are ignored.
  void try_edges(const ArcEdge& own, const ArcEdge& other, double floor = -infinity);

  const SeparatingAxis& best() const { return edge_.gap > face_.gap + margin_ ? edge_ : face_; }
  const SeparatingAxis& face() const { return face_; }
  const SeparatingAxis& edge() const { return edge_; }
  double margin() const { return margin_; }  ///< rounding of separations and bounds [m]
  /// Gap that an edge pair must exceed [m].
  double edge_threshold(double floor) const { return std::max(floor, std::max(face_.gap, edge_.gap - 2.0 * margin_)); }

 private:
  const PolyhedronPair& pair_;
  double margin_;
  SeparatingAxis face_, edge_;
};

}  // namespace epafi
