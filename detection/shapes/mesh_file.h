/// @file mesh_file.h  Triangle surfaces from Wavefront OBJ, STL and PLY (ASCII and binary), and tables of triangles.
/// Strict: an unreadable entry is a SceneError with file:line and text; nothing is repaired silently.
#pragma once
#include <string>
#include <string_view>

#include "detection/mass_properties.h"
#include "engine/units/error.h"

namespace epafi {

/// Quality of a surface: closed or not, orientation, dropped triangles.
struct MeshReport {
  std::size_t open_edges = 0;  ///< edges with one triangle
  std::size_t clashing_edges =
      0;  ///< edges with three or more triangles, or two that run along it in the same direction
  static constexpr std::size_t most_named = 6;
  std::vector<std::array<Vec3, 2>> some_open{};  ///< ends of the first open edges [m]
  std::array<Vec3, 2> first_clash{};             ///< ends of the first clashing edge [m]
  std::size_t dropped = 0;                       ///< triangles without area, left out when reading
  double volume = 0.0;                           ///< signed [m^3]; meaningful where watertight
  double precision = 0.0;                        ///< largest rounding error of coordinates; 0: unknown [m]

  bool is_watertight() const { return open_edges == 0 && clashing_edges == 0; }
  bool is_inverted() const { return is_watertight() && volume < 0.0; }
  /// One sentence for every trouble, "" where there is none.
  std::string to_string() const;
};

struct MeshFile {
  TriangleSurface surface;
  MeshReport report;
};

/// Whether a file must have faces: needed for a surface, optional for the convex hull of its corners.
enum class MeshFaces { needed, optional };

/// Reads by the file's ending (.obj, .stl or .ply, any case). Throws FileError where the file cannot be read,
/// SceneError for its content. Coordinates are metres.
[[nodiscard]] MeshFile read_mesh_file(const std::string& path, MeshFaces faces = MeshFaces::needed);

/// The same from text in memory; `file` is the name in messages. Vertices of an STL with equal coordinates become one;
/// polygons are cut into triangles, those with inner corners by ears (polygon_ears.h).
[[nodiscard]] MeshFile read_obj(std::string_view text, const std::string& file, MeshFaces faces = MeshFaces::needed);
[[nodiscard]] MeshFile read_stl(std::string_view bytes, const std::string& file, MeshFaces faces = MeshFaces::needed);
[[nodiscard]] MeshFile read_ply(std::string_view bytes, const std::string& file, MeshFaces faces = MeshFaces::needed);
/// Rows of nine numbers: a triangle's corners; names of columns may give a unit (mesh_table.cpp).
[[nodiscard]] MeshFile read_triangle_table(std::string_view text, const std::string& file,
                                           MeshFaces faces = MeshFaces::needed);

/// Three corners a triangle: those with equal coordinates become one, numbered in the order of their first appearance.
[[nodiscard]] TriangleSurface welded_surface(const std::vector<Vec3>& corners);

/// Leaves out triangles without area and reports; SceneError where none is left though faces are needed, or no corner.
/// written_precision: of a text (MeshText), or 0 [m].
[[nodiscard]] MeshFile finished_mesh(TriangleSurface surface, const std::string& file,
                                     MeshFaces faces = MeshFaces::needed, double written_precision = 0.0);

/// Counts open and clashing edges and the volume.
[[nodiscard]] MeshReport inspect(const TriangleSurface& surface);

}  // namespace epafi
