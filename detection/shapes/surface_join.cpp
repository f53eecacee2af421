#include "detection/shapes/surface_join.h"

#include <fmt/format.h>

#include "detection/aabb.h"
#include "detection/shapes/face_finder.h"
#include "detection/shapes/surface_weld.h"

namespace epafi {
namespace {

/// Moves corners where some face is not plane to rounding, and notes how far they remain off. Normals stay those of the
/// triangles where all are.
void flatten(JoinedSurface& joined, const FaceFinder& faces, double rounding) {
  TriangleSurface& s = joined.surface;
  const CornerMoves moves = move_into_planes(s, faces, rounding);
  joined.report.moved = moves.count;
  joined.report.move_distance = moves.farthest;
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const std::uint32_t f = faces.face[t];
    const bool own = moves.is_exact || faces.size[f] < 2;
    joined.normals.push_back(own ? plane_of(s, s.triangles[t]).normal : faces.planes[f].normal);
    if (own) continue;
    for (const std::uint32_t v : s.triangles[t]) {
      const double off = std::abs(faces.planes[f].height(s.vertices[v]));
      if (off > rounding) joined.report.unevenness = std::max(joined.report.unevenness, 4.0 * off);
    }
  }
}

}  // namespace

std::string JoinReport::to_string() const {
  std::string text;
  const auto add = [&](const std::string& sentence) { text.append(text.empty() ? "" : ", ").append(sentence); };
  if (welded > 0) add(fmt::format("{} corners joined with others up to {:.2g} m away", welded, weld_distance));
  if (doubled > 0) add(fmt::format("{} triangles given twice left out", doubled));
  if (slivers > 0) add(fmt::format("{} triangles lower than that left out", slivers));
  if (cut > 0) add(fmt::format("{} cuts at corners that lie on a side", cut));
  if (flipped > 0) add(fmt::format("{} triangles turned over", flipped));
  if (moved > 0)
    add(fmt::format("{} corners moved into the planes of their faces by up to {:.2g} m", moved, move_distance));
  if (unevenness > 0.0) add(fmt::format("contacts closer than {:.2g} m are one, as faces stay uneven", unevenness));
  return text.empty() ? text : fmt::format("joined within {:.2g} m: {}", tolerance, text);
}

JoinedSurface join_surface(TriangleSurface surface, double precision) {
  JoinedSurface joined;
  JoinReport& report = joined.report;
  Aabb box;
  double largest = 0.0;
  for (const Triangle& t : surface.triangles)
    for (const std::uint32_t v : t) {
      box.include(surface.vertices[v]);
      largest = std::max(largest, surface.vertices[v].cwiseAbs().maxCoeff());
    }
  const double size = box.extent().norm();
  report.tolerance = std::max(join_tolerance * size, 4.0 * precision);
  report.flatness = std::max(flat_tolerance * size, 4.0 * precision);
  weld_corners(surface, report);
  // corners that are one tell how far all are off
  report.flatness = std::max(report.flatness, 2.0 * report.weld_distance);
  drop_slivers(surface, report);
  cut_at_corners(surface, report);
  turn_alike(surface, report);
  FaceFinder faces(surface, report.flatness);
  joined.surface = std::move(surface);
  flatten(joined, faces, 1e-14 * largest);
  std::vector<std::uint32_t> lowest(faces.planes.size(), FaceFinder::unknown);
  for (std::uint32_t t = 0; t < faces.face.size(); ++t) {
    lowest[faces.face[t]] = std::min(lowest[faces.face[t]], t);
    joined.face.push_back(lowest[faces.face[t]]);
  }
  report.faces = faces.planes.size();
  return joined;
}

}  // namespace epafi
