/// @file axis_search.h  The axis of largest separation of two polyhedra, over all faces and all edge pairs whose Gauss
/// arcs cross (Gregorius 2013).
/// Pruning: along a face normal n of A the separation is at most n.x - offset for every point x of B; over the arc of
/// an edge of A it is at most the larger of its two faces' values (while that is negative). With x on B where it is
/// deepest in A few features survive; the sphere inside the other body prunes what x does not. A start only tightens
/// the pruning: the answer is the same bits with any start, because equal axes are told apart by a fixed order (faces
/// of A, of B, edges; then by index) and everything within rounding of the best is evaluated.
#pragma once
#include <vector>

#include "detection/narrow/polyhedra/gauss_arcs.h"
#include "detection/narrow/polyhedra/pair_memory.h"

namespace epafi {

/// Arrays of a search by face of one body, up to a multiple of four; kept from search to search: no allocation once the
/// largest body was seen.
struct FaceArrays {
  std::vector<double> point, centre;           ///< see FaceHeights
  std::vector<std::uint32_t> deepest, chosen;  ///< chosen: faces or edges that a loop has let through
  void fit(const PolyhedronView& body);
  operator FaceHeights() const { return {point.data(), centre.data(), deepest.data()}; }
};

/// Distances of one polyhedron's features to the other, as far as computed, in its own axes.
struct AxisSide {
  static constexpr std::uint32_t unknown = FaceHeights::unknown;
  const PolyhedronView& own;
  Vec3 other_centre;
  double other_inner;  ///< radius of a sphere about other_centre that the other body surely fills [m]
  FaceArrays& face;
  bool knows_centre = false;

  /// Computes the heights of x, a point of the other body; returns the largest.
  double look_at(const Vec3& x) { return face.point[hull_kernels().heights(own.face_lanes, x, face.point.data())]; }
  void look_at_centre();
  /// The face with the largest sphere bound.
  std::uint32_t most_promising();
  /// No separation along the face's normal is larger.
  double sphere_bound(std::uint32_t f) const { return face.centre[f] - other_inner; }
  /// Edges between whose faces' normals some direction may separate by more than `best`.
  /// separation(n) <= n.x - n.vertex for any x of the other body; over the arc that is largest at an end unless
  /// positive. Where one vertex of the other body is deepest below both faces no direction between is better.
  std::span<const std::uint32_t> promising_edges(double best);
  /// The sphere alone, over the inside of the arc.
  bool sphere_may_exceed(const HullEdge& edge, double best) const;
};

class AxisSearch {
 public:
  explicit AxisSearch(const PolyhedronPair& pair);
  /// Starts from the separation along the features of an earlier axis.
  void start_from(const SeparatingAxis& axis);
  /// The same with the face of each body that has the largest sphere bound.
  void start_promising();
  /// The best of the starts.
  const SeparatingAxis& best() const { return tried_.best(); }
  /// The best axis. floor: a known separation; if none exceeds it, the kind is none.
  SeparatingAxis run(double floor = -infinity);
  /// The features that separate by more than the best start less `range` [m], for later poses. Only below 0, and where
  /// they are few: otherwise `out` stays unknown.
  void keep(double range, AxisReference& out);

 private:
  static constexpr std::size_t chunk = 64;  // edges of A held at a time: 6 kB of stack

  void try_face_a(std::uint32_t f);
  void try_face_b(std::uint32_t f);
  void try_faces();
  void try_edges();
  void try_against(std::span<const ArcLanes> held, std::span<const std::uint32_t> names);
  void look_at_deepest();
  bool keep_faces(double threshold, AxisReference& out);
  bool keep_crossings(double threshold, AxisReference& out);

  const PolyhedronPair& pair_;
  AxisSide side_a_, side_b_;
  AxisCandidates tried_;
  double floor_ = -infinity;
};

/// The best axis among the features of a reference if these certainly contain it, with the bits of a search. False if
/// the bodies have moved too far since.
bool recall_axis(const PolyhedronPair& pair, const AxisReference& reference, SeparatingAxis& out);

/// Closest points of the lines through the two edges, each kept on its edge.
void edge_points(const PolyhedronPair& pair, std::uint32_t edge_a, std::uint32_t edge_b, const Vec3& normal, Vec3& on_a,
                 Vec3& on_b);

/// The largest of the 15 separations of two boxes (Gottschalk, Lin and Manocha 1996).
struct BoxAxis {
  SeparatingAxis axis;  ///< a start for the search
  bool alone = false;   ///< no other axis is close: the result of the search
};
/// Both must have `box`.
BoxAxis box_axis(const PolyhedronPair& pair);

}  // namespace epafi
