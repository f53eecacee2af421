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

/// A corner where the outline of a face turns inwards, and the cone, seen from it, of what was gathered in
/// its plane.
struct RegionNotch {
  std::uint32_t face, vertex;
  Vec3 right = Vec3::Zero(), left = Vec3::Zero();  ///< to the outermost corners, less than half a turn apart [m]
};

struct MeshRegion {
  bool front = true;                     ///< its outside is the front of its triangles
  std::uint32_t first = 0;               ///< the triangle it was gathered around
  std::vector<std::uint32_t> triangles;  ///< ascending
  std::vector<RegionPlane> planes;
  std::vector<RegionNotch> notches;  ///< of all candidates
  std::vector<Vec3> corners;         ///< relative to the body's centre, mesh axes [m]
  double radius = 0.0;               ///< of the sphere about the body's centre that contains it [m]

  Vec3 support(const Vec3& d) const;
};

/// The region around triangle t among the candidates, seen from its front or back.
void gather_region(const PlacedCore& body, std::span<const std::uint32_t> triangles, std::uint32_t t, bool front,
                   MeshRegion& region);

/// Signed distance of a core and a region.
struct WayOut {
  double gap = 0.0;  ///< of the core [m]
  Vec3 normal;       ///< from the region to the body
  Vec3 on_mesh;      ///< the nearest or deepest point [m]
  double uncertainty = 0.0;
};
WayOut find_way_out(const PlacedCore& body, const MeshRegion& region);

/// True if the body is beyond its reach of the triangle, by more than rounding, according to its sphere, the triangle's
/// normal or the direction across its nearest side; a search would find no contact. Of 2600 candidates a step of 30
/// stones in a hopper, 1040 are near by the sphere, 100 by all three tests.
bool is_out_of_reach(const PlacedCore& body, std::uint32_t t);

/// True if the distance of body and triangle is within the reach. Lists of candidates contain all such triangles and,
/// with age, others; results of such triangles alone do not depend on the age of a list.
bool is_near(const PlacedCore& body, std::uint32_t t);

/// Side of the surface on which x is, by triangle (ascending): the same for connected triangles, even if the planes of
/// some differ. front: 1, back: 0.
void find_sides(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, const Vec3& x,
                std::vector<unsigned char>& front);

inline std::size_t place_of(std::span<const std::uint32_t> triangles, std::uint32_t t) {
  return static_cast<std::size_t>(std::lower_bound(triangles.begin(), triangles.end(), t) - triangles.begin());
}

}  // namespace epafi
