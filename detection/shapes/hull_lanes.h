/// @file hull_lanes.h  Vertices, faces and edges of a polyhedron four at a time, and the loops that a search for the
/// separating axis spends its time in. Each loop is written once over the lanes of engine/lanes/lanes.h and compiled
/// for SSE2, AVX2 and AVX-512; the widest that the processor runs is chosen at start. All give the same bits.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "engine/lanes/lanes.h"
#include "engine/state/types.h"

namespace epafi {

// alignas: the vector types alone are aligned for the target of the file that declares them, 16 bytes for SSE2, and
// loops for AVX2 rely on 32.
struct alignas(32) VertexLanes {
  Lanes3 at;  ///< the last vertex again where there are fewer than four [m]
};
struct alignas(32) FaceLanes {
  Lanes3 normal;
  Lanes offset;  ///< infinite where there is no face: below everything [m]
};
struct alignas(32) EdgeLanes {
  std::array<std::uint32_t, 4> left, right;  ///< faces
  Lanes cosine;                              ///< of the angle between their normals
};
/// An edge as an arc on the Gauss sphere, between the normals of its faces.
struct Arc {
  Vec3 from, along, left, right;
};
/// Arcs in the same axes; an empty lane is 0 and crosses nothing.
struct alignas(32) ArcLanes {
  Lanes3 from, along, left, right;
  void set(std::size_t k, const Arc& arc);
};

/// Edge of a convex polyhedron, listed once: `left` is the face that runs from -> to counter-clockwise.
struct HullEdge {
  std::uint32_t from, to, left, right;
};

/// The group that begins at number `first`.
VertexLanes vertex_lanes(std::span<const Vec3> vertices, std::size_t first);
FaceLanes face_lanes(std::span<const Vec3> normals, std::span<const double> offsets, std::size_t first);
EdgeLanes edge_lanes(std::span<const HullEdge> edges, std::span<const Vec3> normals, std::size_t first);

struct HullLanes {
  std::vector<VertexLanes> vertices;
  std::vector<FaceLanes> faces;
  std::vector<EdgeLanes> edges;
};

/// Heights of the other body over the faces of one; arrays by face, padded to a multiple of four.
struct FaceHeights {
  const double* point;           ///< height of one point of the other body above the face [m]
  const double* centre;          ///< height of the other body's centre [m]
  const std::uint32_t* deepest;  ///< deepest vertex of the other body, or `unknown`
  static constexpr std::uint32_t unknown = 0xffffffffu;
};

/// Indices are written to `out`, which holds as many as there are lanes; the count is returned.
struct HullKernels {
  const char* name;
  /// The first of the vertices farthest along d.
  std::uint32_t (*farthest)(std::span<const VertexLanes>, const Vec3& d);
  /// Heights of x above all faces; the first face of the largest.
  std::uint32_t (*heights)(std::span<const FaceLanes>, const Vec3& x, double* out);
  /// Every point is lower than `least` (finite) above every face but those of `own`.
  bool (*all_below)(std::span<const FaceLanes>, std::span<const Vec3> points, double least,
                    std::span<const std::uint32_t> own);
  /// Faces whose point is at `point` or higher and whose centre at `centre` or higher.
  std::size_t (*high_faces)(const FaceHeights&, std::size_t faces, double point, double centre, std::uint32_t* out);
  /// Edges over whose arcs a separation above `best` is not excluded by their two faces: see AxisSide. inner: radius of
  /// a sphere that the other body fills about its centre; slack: rounding of heights [m].
  std::size_t (*promising_edges)(std::span<const EdgeLanes>, const FaceHeights&, double best, double inner,
                                 double slack, std::uint32_t* out);
  /// Arcs that cross the other one and whose axis separates by `least` or more [m].
  std::size_t (*crossing_arcs)(std::span<const ArcLanes>, const Arc& other, double least, std::uint32_t* out);
};

/// For engine/lanes/targets.h's target() at the first call.
const HullKernels& hull_kernels();
/// Up to that one, the narrowest first.
std::span<const HullKernels> all_hull_kernels();

}  // namespace epafi
