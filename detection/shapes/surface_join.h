/// @file surface_join.h  Makes one surface of the triangles of a file: corners that are one within the tolerance become
/// one, triangles given twice and slivers go, triangles are cut where a corner of another lies on their side, turned to
/// agree with their neighbours, and gathered to faces. A face is a plane within the rounding of the file; where that
/// has left its corners beside the plane, they are moved into the planes of all faces that meet there. What is exact to
/// rounding stays as it is, bit for bit. Limits: where more than three faces meet that are nearly parallel, a corner
/// may stay beside them by the tolerance.
#pragma once
#include <string>

#include "detection/shapes/triangle_surface.h"

namespace epafi {

struct JoinReport {
  double tolerance = 0.0;      ///< of corners and sides [m]
  double flatness = 0.0;       ///< of faces [m]
  std::size_t welded = 0;      ///< corners that became one with another
  double weld_distance = 0.0;  ///< the farthest that such a corner lay from the other [m]
  std::size_t slivers = 0;     ///< triangles lower than the tolerance, left out
  std::size_t doubled = 0;     ///< triangles given again, left out
  std::size_t cut = 0;         ///< cuts of triangles at a corner on their side
  std::size_t flipped = 0;     ///< triangles turned to agree with their neighbours
  std::size_t moved = 0;       ///< corners moved into the planes of their faces
  double move_distance = 0.0;  ///< the farthest of these moves [m]
  std::size_t faces = 0;

  /// What was joined and how far off it was; "" where nothing was.
  std::string to_string() const;
};

struct JoinedSurface {
  TriangleSurface surface;
  std::vector<std::uint32_t> face;  ///< by triangle: the lowest triangle of its face
  std::vector<Vec3> normals;        ///< by triangle: of its face, unit
  JoinReport report;
};

/// Of the diagonal of the box about all corners: what is nearer is one. A ten millionth of a metre of a seam of 0.2 m
/// and slivers of a micrometre on a floor of two metres are below it, and a plate of 0.1 mm of 30 m is above.
inline constexpr double join_tolerance = 1e-6;
/// The same for the corners of a face: a drum of 20 000 sides stays one.
inline constexpr double flat_tolerance = 1e-9;

/// precision: how far a coordinate of the file may be off by its rounding [m]; four times as much is joined and is
/// flat.
[[nodiscard]] JoinedSurface join_surface(TriangleSurface surface, double precision);

}  // namespace epafi
