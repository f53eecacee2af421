/// @file mesh_region.h  The convex regions of a surface: a triangle with neighbours that bend away from it and from
/// each other; of a face with notches or holes a convex part. The overlap of a body is limited to the shortest way out
/// of the region's convex hull, on faces, edges and corners.
#pragma once
#include "detection/narrow/gjk/minkowski.h"
#include "detection/narrow/mesh/mesh_contact.h"

namespace epafi {

/// A convex core and the sphere swept over it, in the mesh's axes.
struct PlacedCore {
  ConvexRef core;
  double sweep;  ///< [m]
  Pose pose;
  Mat3 turn;
  double reach, tolerance;  ///< [m]
  const TriangleMesh* mesh;

  /// Its point farthest along d.
  Vec3 tip(const Vec3& d) const { return pose.position + turn * core.support(turn.transpose() * d); }
};

/// The plane of a face of a region, towards its outside.
struct RegionPlane {
  Vec3 normal, point;
  std::uint32_t triangle;  ///< one of the face
  double gap = 0.0;        ///< of a core along the normal [m]
};

/// A corner where the outline of a face turns inwards.
struct FaceNotch {
  std::uint32_t face, vertex;
  bool operator==(const FaceNotch&) const = default;
};

struct MeshRegion {
  bool front = true;                     ///< its outside is the front of its triangles
  std::uint32_t first = 0;               ///< the triangle it was gathered around
  std::vector<std::uint32_t> triangles;  ///< ascending
  std::vector<RegionPlane> planes;
  std::vector<FaceNotch> notches;  ///< of all candidates
  std::vector<Vec3> corners;       ///< relative to the body's centre, mesh axes [m]
  double radius = 0.0;             ///< of the sphere about the body's centre that contains it [m]

  Vec3 support(const Vec3& d) const;
};

/// The region around triangle t among the candidates, seen from its front or back.
void gather_region(const PlacedCore& body, std::span<const std::uint32_t> triangles, std::uint32_t t, bool front,
                   MeshRegion& region);

/// Calls f(t, k) for the rims of a region: sides k of its triangles t where its surface bends to another of them.
template <class F>
void each_rim(const TriangleMesh& mesh, const MeshRegion& region, const F& f) {
  for (const std::uint32_t t : region.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t next = mesh.neighbours[t][k];
      if (mesh.edge_kinds[t][k] == (region.front ? EdgeKind::convex : EdgeKind::concave) && next > t &&
          std::ranges::binary_search(region.triangles, next))
        f(t, k);
    }
}

/// Adds the rims' continuations where they end at a wall: the solid goes on behind it, as far as the body reaches or up
/// to the next surface. (Seen alone, the side of a hole ends in a corner that a body there would slip past.) True: some
/// were added.
bool continue_rims(const PlacedCore& body, MeshRegion& region);

/// Signed distance of a core and a region.
struct WayOut {
  double gap = 0.0;  ///< of the core [m]
  Vec3 normal;       ///< from the region to the body
  Vec3 on_mesh;      ///< the nearest or deepest point [m]
  double uncertainty = 0.0;
};
WayOut find_way_out(const PlacedCore& body, const MeshRegion& region);

/// The body is within its reach of the triangle, by the distance of both. Lists of candidates hold all such triangles
/// and, as old as they are, some others: what is found among these alone does not depend on the age of a list.
bool is_near(const PlacedCore& body, std::uint32_t t);

/// Side of the surface on which x is, by triangle (ascending): the same for connected triangles, even if the planes of
/// some differ. front: 1, back: 0.
void find_sides(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, const Vec3& x,
                std::vector<unsigned char>& front);

inline std::size_t place_of(std::span<const std::uint32_t> triangles, std::uint32_t t) {
  return static_cast<std::size_t>(std::lower_bound(triangles.begin(), triangles.end(), t) - triangles.begin());
}

}  // namespace epafi
