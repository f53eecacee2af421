#include "detection/shapes/hull_from_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>

#include "detection/shapes/exact_hull.h"
#include "detection/shapes/face_finder.h"
#include "detection/shapes/surface_weld.h"

namespace epafi {
namespace {

constexpr double flat = 1e-9;        // of the extent: thinner sets have no usable inertia in double precision
constexpr double redundant = 1e-12;  // of the extent: what rounding lifts a point of a face or edge out of it

bool before(const Vec3& a, const Vec3& b) { return std::tuple(a.x(), a.y(), a.z()) < std::tuple(b.x(), b.y(), b.z()); }

/// Lexicographic order without duplicates: makes the result independent of the order of the input.
std::vector<Vec3> sorted_distinct(std::span<const Vec3> points, const Place& place) {
  std::vector<Vec3> out;
  out.reserve(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!points[k].allFinite())
      throw SceneError("vertex " + std::to_string(k) + " of the polyhedron is not finite", place);
    out.push_back(points[k] + Vec3::Zero());  // -0 becomes 0
  }
  std::sort(out.begin(), out.end(), before);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Four points far apart: the 2nd, 3rd and 4th farthest from the point, line and plane of those before.
struct LargeSimplex {
  std::array<std::uint32_t, 4> corners{};
  double length = 0.0, width = 0.0, height = 0.0;  ///< those distances [m]
  bool is_flat() const { return !(height > flat * length); }
};

LargeSimplex large_simplex(const std::vector<Vec3>& points) {
  LargeSimplex out;
  const auto take_farthest = [&](std::size_t k, auto&& distance) {
    const auto at = std::max_element(points.begin(), points.end(),
                                     [&](const Vec3& a, const Vec3& b) { return distance(a) < distance(b); });
    out.corners[k] = static_cast<std::uint32_t>(at - points.begin());
    return distance(*at);
  };
  const Vec3 a = points.front();
  out.length = take_farthest(1, [&](const Vec3& p) { return (p - a).norm(); });
  if (out.length == 0.0) return out;
  const Vec3 along = (points[out.corners[1]] - a).normalized();
  out.width = take_farthest(2, [&](const Vec3& p) { return (p - a).cross(along).norm(); });
  if (out.width == 0.0) return out;
  const Vec3 normal = along.cross(points[out.corners[2]] - a).normalized();
  out.height = take_farthest(3, [&](const Vec3& p) { return std::abs(normal.dot(p - a)); });
  return out;
}

/// Hull of sorted points; vertices sorted, each triangle begins with its lowest vertex, triangles sorted.
HullSurface hull_of(const std::vector<Vec3>& points, const LargeSimplex& simplex) {
  const auto triangles = exact_hull(points, simplex.corners);
  std::vector<std::uint32_t> vertex(points.size(), 0);
  for (const auto& t : triangles)
    for (const std::uint32_t p : t) vertex[p] = 1;
  HullSurface hull;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (vertex[p] == 0) continue;
    vertex[p] = static_cast<std::uint32_t>(hull.vertices.size());
    hull.vertices.push_back(points[p]);
  }
  for (const auto& [a, b, c] : triangles) hull.faces.push_back({vertex[a], vertex[b], vertex[c]});
  std::sort(hull.faces.begin(), hull.faces.end());
  return hull;
}

TriangleSurface surface_of(const HullSurface& hull) { return {hull.vertices, triangles_of(hull)}; }

/// Vertices where at least three faces meet, of those within the tolerance of each other one. The others lie on a face
/// or an edge: rounding has lifted them, and they make slivers without a usable normal.
std::vector<Vec3> true_corners(const HullSurface& hull, double tolerance) {
  TriangleSurface surface = surface_of(hull);
  JoinReport report;
  report.tolerance = tolerance;
  weld_corners(surface, report);
  if (report.welded > 0) return surface.vertices;
  const FaceFinder faces(surface, tolerance);
  std::vector<std::set<std::uint32_t>> at(surface.vertices.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (const std::uint32_t v : surface.triangles[t]) at[v].insert(faces.face[t]);
  std::vector<Vec3> corners;
  for (std::size_t v = 0; v < at.size(); ++v)
    if (at[v].size() > 2) corners.push_back(surface.vertices[v]);
  return corners;
}

/// The outline of each face; nothing where one is no simple polygon.
std::vector<std::vector<std::uint32_t>> outlines(const TriangleSurface& surface, const FaceFinder& faces) {
  std::vector<std::map<std::uint32_t, std::uint32_t>> next(faces.planes.size());
  const auto uses = sorted_edge_uses(surface.triangles);
  for (std::size_t k = 0; k + 1 < uses.size(); k += 2) {  // a closed surface: two uses of each edge
    if (faces.face[uses[k].triangle] == faces.face[uses[k + 1].triangle]) continue;
    for (const EdgeUse& u : {uses[k], uses[k + 1]}) {
      const std::uint32_t from = u.forward ? u.low : u.high, to = u.forward ? u.high : u.low;
      if (!next[faces.face[u.triangle]].emplace(from, to).second) return {};
    }
  }
  std::vector<std::vector<std::uint32_t>> out;
  for (const auto& after : next) {
    if (after.empty()) return {};
    auto& loop = out.emplace_back(1, after.begin()->first);
    for (std::uint32_t v = after.at(loop.front()); v != loop.front(); v = after.at(v)) loop.push_back(v);
    if (loop.size() != after.size()) return {};
  }
  return out;
}

/// Facets within the tolerance of one plane become one face; vertices are moved into the planes that meet there.
void join_facets(HullSurface& hull, double tolerance) {
  TriangleSurface surface = surface_of(hull);
  const FaceFinder faces(surface, tolerance);
  auto polygons = outlines(surface, faces);
  if (polygons.size() < 4) return;
  move_into_planes(surface, faces, 0.0);
  hull = {std::move(surface.vertices), std::move(polygons), tolerance};
}

}  // namespace

HullSurface hull_from_points(std::span<const Vec3> points, const Place& place, double precision) {
  const auto distinct = sorted_distinct(points, place);
  if (distinct.size() < 4)
    throw SceneError("a polyhedron needs at least 4 distinct vertices, found " + std::to_string(distinct.size()),
                     place);
  const LargeSimplex size = large_simplex(distinct);
  if (size.is_flat())
    throw SceneError(std::string("the vertices of the polyhedron lie on one ") +
                         (size.width > flat * size.length ? "plane" : "line") + ": they enclose no volume",
                     place);
  HullSurface hull = hull_of(distinct, size);
  const double tolerance = std::max(redundant * size.length, 4.0 * precision);
  for (;;) {
    const auto corners = true_corners(hull, tolerance);
    if (corners.size() == hull.vertices.size() || corners.size() < 4) break;
    const LargeSimplex rest = large_simplex(corners);
    if (rest.is_flat()) break;
    hull = hull_of(corners, rest);
  }
  if (precision > 0.0) join_facets(hull, tolerance);
  return hull;
}

}  // namespace epafi
