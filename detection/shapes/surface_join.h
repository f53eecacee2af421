/// @file surface_join.h  Joins the triangles of a file to one surface: merges corners within the tolerance, drops
/// duplicate triangles and slivers, splits triangles at corners of others on their sides, flips them to agree with
/// their neighbours, and groups them to faces. A face is plane within the rounding of the file; its corners are moved
/// into the planes of all faces that meet there. Coordinates that are exact to rounding do not change by a bit. Limits:
/// where more than three faces meet, a corner may remain off their planes by the file's rounding; contacts that close
/// to each other are one (JoinReport::unevenness).
#pragma once
#include <string>

#include "detection/shapes/triangle_surface.h"

namespace epafi {

struct JoinReport {
  double tolerance = 0.0;      ///< of corners and sides [m]
  double flatness = 0.0;       ///< of faces [m]
  std::size_t welded = 0;      ///< corners merged with another
  double weld_distance = 0.0;  ///< largest distance of merged corners [m]
  std::size_t slivers = 0;     ///< triangles with a height below the tolerance, dropped
  std::size_t doubled = 0;     ///< duplicate triangles, dropped
  std::size_t cut = 0;         ///< cuts of triangles at a corner on their side
  std::size_t flipped = 0;     ///< triangles flipped to agree with their neighbours
  std::size_t moved = 0;       ///< corners moved into the planes of their faces
  double move_distance = 0.0;  ///< the farthest of these moves [m]
  double unevenness = 0.0;     ///< four times how far corners remain off the planes of their faces; 0: none does [m]
  std::size_t faces = 0;

  /// Summary of the corrections with the largest distances; "" if there were none.
  std::string to_string() const;
};

struct JoinedSurface {
  TriangleSurface surface;
  std::vector<std::uint32_t> face;  ///< by triangle: the lowest triangle of its face
  std::vector<Vec3> normals;        ///< by triangle: of its face, unit
  JoinReport report;
};

/// Tolerance over the diagonal of the box about all corners. It merges gaps of 1e-7 m in a seam of 0.2 m and slivers of
/// a micrometre on a floor of two metres, but not the sides of a plate of 30 m and 0.1 mm.
inline constexpr double join_tolerance = 1e-6;
/// The same for the flatness of a face: a drum of 20 000 sides keeps its sides.
inline constexpr double flat_tolerance = 1e-9;

/// precision: rounding error of the file's coordinates [m]; tolerance and flatness are at least four times this.
[[nodiscard]] JoinedSurface join_surface(TriangleSurface surface, double precision);

}  // namespace epafi
