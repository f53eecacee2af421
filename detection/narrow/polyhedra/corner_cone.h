/// @file corner_cone.h  The cone of a polyhedron at one of its vertices, split into parts with one nearest face each.
/// It does not depend on the pose; a plane that cuts the corner off cuts every part into tetrahedra.
///
/// Depths below the faces are linear, so the parts meet in rays from the vertex: the edges, and inside a ray for every
/// triple of faces that is as deep below all three and below no other face less. These triples triangulate the polygon
/// of the normals on the Gauss sphere, the circle of each containing all others (Delaunay's of the farthest point);
/// with normals l, m, n the ray points along -(l x m + m x n + n x l). Where four faces are as near any triangulation
/// is right.
#pragma once
#include <array>
#include <cstdint>

#include "detection/shapes/convex_hull.h"

namespace epafi {

class CornerCone {
 public:
  static constexpr std::size_t most_faces = 12;  ///< around the vertex; stones of 20 vertices have 9 at most
  static constexpr std::size_t most_rays = 2 * most_faces - 2;
  struct Ray {
    Vec3 along;    ///< from the vertex, any length
    double depth;  ///< at its end, below the faces that it is between
  };
  struct Tetrahedron {
    std::array<std::uint8_t, 3> ray;  ///< from the vertex along these rays
    std::uint8_t part;
  };

  /// False where there are more faces, or one that misses the vertex by more than rounding.
  bool assign(const PolyhedronView& view, std::uint32_t vertex);
  /// Counter-clockwise seen from outside.
  std::span<const std::uint32_t> faces() const { return {face_.data(), face_count_}; }
  /// The edges first: edge i is between face i and the one before it.
  std::span<const Ray> rays() const { return {rays_.data(), ray_count_}; }
  std::span<const Tetrahedron> tetrahedra() const { return {tetrahedra_.data(), tetrahedron_count_}; }

 private:
  bool take_faces(const PolyhedronView& view, std::uint32_t vertex);
  void split(std::size_t i, std::size_t j, std::size_t outer);
  void add(std::size_t part, std::size_t p, std::size_t q);

  std::size_t face_count_ = 0, ray_count_ = 0, tetrahedron_count_ = 0;
  std::array<std::uint32_t, most_faces> face_;
  std::array<Vec3, most_faces> normal_;
  std::array<Ray, most_rays> rays_;
  std::array<Tetrahedron, 3 * most_faces - 6> tetrahedra_;
};

}  // namespace epafi
