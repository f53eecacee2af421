/// @file axis_search.h  The axis of largest separation of two polyhedra, over all faces and all edge pairs whose Gauss
/// arcs cross (Gregorius 2013).
/// Pruning: along a face normal n of A the separation is at most n.x - offset for every point x of B; over the arc of
/// an edge of A it is at most the larger of its two faces' values (while that is negative). With x on B where it is
/// deepest in A few features survive; the sphere inside the other body prunes what x does not. A start only tightens
/// the pruning: the answer is the same bits with any start, because equal axes are told apart by a fixed order (faces
/// of A, of B, edges; then by index) and everything within rounding of the best is looked at.
#pragma once
#include <vector>

#include "detection/narrow/gauss_arcs.h"
#include "detection/narrow/pair_memory.h"

namespace epafi {

/// What is known of one polyhedron's features against the other, in its own axes.
struct AxisSide {
  static constexpr std::uint32_t unknown = 0xffffffffu;
  const PolyhedronView& own;
  Vec3 other_centre;
  double other_inner;                   ///< radius of a sphere about other_centre that the other body surely fills [m]
  std::vector<double>& height;          ///< by face: of one point of the other body above its plane [m]
  std::vector<std::uint32_t>& deepest;  ///< by face: the other body's deepest vertex below it, or `unknown`

  /// Takes the heights of x, a point of the other body; the largest of them.
  double look_at(const Vec3& x);
  /// No separation along the face's normal is larger.
  double sphere_bound(std::uint32_t f) const {
    return own.face_normals[f].dot(other_centre) - own.face_offsets[f] - other_inner;
  }
  /// The face with the largest sphere bound.
  std::uint32_t most_promising() const;
  /// Can some direction between the normals of the edge's faces separate by more than `best`?
  /// separation(n) <= n.x - n.vertex for any x of the other body; over the arc that is largest at an end unless
  /// positive.
  bool edge_may_exceed(const HullEdge& edge, double best) const {
    if (best < 0.0) {
      if (!(std::max(height[edge.left], height[edge.right]) > best)) return false;
      // One vertex deepest below both faces: over the arc no direction is better than these two, which are not.
      if (deepest[edge.left] == deepest[edge.right] && deepest[edge.left] != unknown) return false;
    }
    return sphere_may_exceed(edge, best);
  }
  bool sphere_may_exceed(const HullEdge& edge, double best) const;
};

class AxisSearch {
 public:
  explicit AxisSearch(const PolyhedronPair& pair);
  /// Takes the separation along the features of an axis found earlier as something to exceed.
  void start_from(const SeparatingAxis& axis);
  /// The same with the face of each body that has the largest sphere bound.
  void start_promising();
  /// The best of the starts.
  const SeparatingAxis& best() const { return tried_.best(); }
  /// The best axis. `floor`: a separation known by other means; where nothing exceeds it, the kind is none.
  SeparatingAxis run(double floor = -infinity);
  /// The features that separate by more than the best start less `range` [m], for later poses. Only below 0, and where
  /// they are few: otherwise `out` stays unknown.
  void keep(double range, AxisReference& out);

 private:
  static constexpr std::uint32_t chunk = 64;  // edges of A held at a time: 5 kB of stack

  void try_face_a(std::uint32_t f);
  void try_face_b(std::uint32_t f);
  void try_faces();
  void try_edges();
  void try_against(std::span<const ArcEdge> held);
  void look_at_deepest();
  bool keep_faces(double threshold, AxisReference& out);
  bool keep_crossings(double threshold, AxisReference& out);

  const PolyhedronPair& pair_;
  AxisSide side_a_, side_b_;
  AxisCandidates tried_;
  double floor_ = -infinity;
};

/// The best axis where the features of a reference certainly hold it: the bits that a search would give. False where
/// the bodies have moved too far since.
bool recall_axis(const PolyhedronPair& pair, const AxisReference& reference, SeparatingAxis& out);

/// Closest points of the lines through the two edges, each kept on its edge.
void edge_points(const PolyhedronPair& pair, std::uint32_t edge_a, std::uint32_t edge_b, const Vec3& normal, Vec3& on_a,
                 Vec3& on_b);

/// Best of the 15 axes of two boxes, as a start (Gottschalk, Lin and Manocha 1996). Both must have `box`.
SeparatingAxis box_axis(const PolyhedronPair& pair);

}  // namespace epafi
