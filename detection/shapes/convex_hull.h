/// @file convex_hull.h  Convex polyhedron with its topology, optionally swept by a sphere ("polyhedron" in scenes).
/// Everything the separating-axis test, clipping and hill climbing look up is computed once, in from_faces.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "detection/shapes/hull_lanes.h"
#include "detection/shapes/shape_concept.h"

namespace epafi {

/// Data of a polyhedron that is a rectangular box of any orientation, for the 15-axis test.
struct BoxFrame {
  Vec3 centre = Vec3::Zero(), half = Vec3::Zero();  ///< half: extent along each of its axes [m]
  std::array<std::array<std::uint32_t, 2>, 3>
      face{};  ///< of axis i, the lower [0] and the upper [1]; the axis is the upper's normal
  std::array<std::array<std::uint32_t, 4>, 3>
      edge{};         ///< along axis i at 2 (upper on axis i + 1) + (upper on axis i + 2)
  double skew = 0.0;  ///< largest cosine between its axes, or sum of two opposite normals
};

/// View of a polyhedron: a hull, a box or a single triangle (two faces back to back). Coordinates are relative to the
/// shape's own origin, which lies inside (on, for a triangle) the shape.
struct PolyhedronView {
  std::span<const Vec3> vertices;
  std::span<const std::uint32_t> face_begin, face_vertices;  ///< CSR, counter-clockwise seen from outside
  std::span<const Vec3> face_normals;                        ///< unit, outward
  std::span<const double> face_offsets;                      ///< normal . x = offset on the face [m]
  std::span<const HullEdge> edges;
  /// CSR of vertices joined by an edge, counter-clockwise around each vertex seen from outside.
  std::span<const std::uint32_t> neighbour_begin, neighbours;
  std::span<const std::uint32_t> fan_begin, fans;  ///< CSR of the faces, face k left of the edge to neighbour k
  double radius = 0.0;                             ///< of the sphere about the origin that contains it [m]
  double inner_radius = 0.0;                       ///< of the sphere about the origin that it contains [m]
  const BoxFrame* box = nullptr;                   ///< where it is a box
  std::span<const std::uint32_t> starts = {};      ///< of large hulls: farthest vertex by cell of directions
  std::span<const VertexLanes> vertex_lanes;       ///< the vertices again, four at a time
  std::span<const FaceLanes> face_lanes;           ///< the faces' planes
  std::span<const EdgeLanes> edge_lanes;
};

struct ConvexHull {
  static constexpr const char* name = "polyhedron";

  std::vector<Vec3> vertices;  ///< body axes: origin at the centre of mass, axes principal [m]
  std::vector<std::uint32_t> face_begin, face_vertices;  ///< CSR; coplanar triangles are merged into one face
  std::vector<Vec3> face_normals;
  std::vector<double> face_offsets;
  using Edge = HullEdge;
  std::vector<Edge> edges;
  std::vector<std::uint32_t> neighbour_begin, neighbours;
  std::vector<std::uint32_t> fan_begin, fans;
  double radius = 0.0;          ///< of the core, about the origin [m]
  double inner_radius = 0.0;    ///< smallest face offset [m]
  double volume = 0.0;          ///< of the core [m^3]
  Mat3 inertia = Mat3::Zero();  ///< of the core about the origin at density 1 [kg m^2]
  std::vector<std::uint32_t>
      starts;  ///< farthest vertex along each cell of a cube of directions; empty for small hulls
  std::optional<BoxFrame> box_frame;  ///< where it is a box, to 1e-9 of the radius
  HullLanes lanes;                    ///< the same four at a time
  double sweep = 0.0;                 ///< `rounding` of the scene: radius of the sphere swept over the core [m]

  /// Builds topology and planes from outward counter-clockwise polygons (triangles or larger, at least 4).
  /// `problem` is empty when the surface is closed, consistently oriented, convex and contains the origin;
  /// otherwise it says what is wrong and `hull` must not be used. Faces that agree within 1e-13 of the radius are
  /// merged.
  struct Built;
  static Built from_faces(std::vector<Vec3> vertices, const std::vector<std::vector<std::uint32_t>>& faces);

  static Entry entry();

  /// Prefetches the data that a pair of polyhedra reads.
  void prefetch() const;
  double bounding_radius() const { return radius + sweep; }
  Aabb bounding_box(const Pose& pose) const;
  /// Mass properties of the core polyhedron; the sweep counts as a thin skin without mass.
  MassProperties mass_properties() const { return {volume, Vec3::Zero(), inertia}; }
  /// Radius of the sphere of equal volume [m], used for R*.
  double contact_radius() const { return equal_volume_radius; }
  double equal_volume_radius = 0.0;

  /// Vertex farthest along d (body axes, any length > 0).
  Vec3 support(const Vec3& d) const;
  double rounding() const { return sweep; }
  PolyhedronView view() const;

  /// Scan up to 96 vertices, hill climbing beyond (convexity: a local maximum is the global one) from the vertex of the
  /// direction's cell where start is 0. Ties: any of the best.
  static std::uint32_t support_vertex(const PolyhedronView& p, const Vec3& d, std::uint32_t start = 0);
  /// Hill climbing from a vertex near the answer.
  static std::uint32_t climb(const PolyhedronView& p, const Vec3& d, std::uint32_t start);
};

struct ConvexHull::Built {
  ConvexHull hull;
  std::string problem;  ///< empty: fine
};

/// A sharp or swept convex polyhedron: view() gives faces and edges.
template <class S>
concept PolyhedralShape = ConvexShape<S> && requires(const S& s) {
  { s.view() } -> std::same_as<PolyhedronView>;
};

static_assert(SolidShape<ConvexHull> && PolyhedralShape<ConvexHull>);

}  // namespace epafi
