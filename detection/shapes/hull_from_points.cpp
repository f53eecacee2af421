#include "detection/shapes/hull_from_points.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>

#include "detection/narrow/point_triangle.h"

namespace epafi {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using HullMesh = CGAL::Surface_mesh<Kernel::Point_3>;

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

/// Greedy largest simplex: distances of the 2nd, 3rd and 4th point from the point, line and plane of those before.
std::array<double, 3> extents(const std::vector<Vec3>& points) {
  const auto farthest = [&](auto&& distance) {
    return *std::max_element(points.begin(), points.end(),
                             [&](const Vec3& a, const Vec3& b) { return distance(a) < distance(b); });
  };
  const Vec3 a = points.front();
  const auto from_point = [&](const Vec3& p) { return (p - a).norm(); };
  const Vec3 b = farthest(from_point);
  if (from_point(b) == 0.0) return {0.0, 0.0, 0.0};
  const Vec3 along = (b - a).normalized();
  const auto from_line = [&](const Vec3& p) { return (p - a).cross(along).norm(); };
  const Vec3 c = farthest(from_line);
  if (from_line(c) == 0.0) return {from_point(b), 0.0, 0.0};
  const Vec3 normal = along.cross(c - a).normalized();
  const auto from_plane = [&](const Vec3& p) { return std::abs(normal.dot(p - a)); };
  return {from_point(b), from_line(c), from_plane(farthest(from_plane))};
}

/// Hull of sorted points; vertices sorted, each triangle begins with its lowest vertex, triangles sorted.
HullSurface exact_hull(const std::vector<Vec3>& points) {
  std::vector<Kernel::Point_3> input;
  input.reserve(points.size());
  for (const Vec3& p : points) input.emplace_back(p.x(), p.y(), p.z());
  HullMesh mesh;
  CGAL::convex_hull_3(input.begin(), input.end(), mesh);
  HullSurface hull;
  for (const auto v : mesh.vertices())
    hull.vertices.emplace_back(mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z());
  const auto unsorted = hull.vertices;
  std::sort(hull.vertices.begin(), hull.vertices.end(), before);
  const auto index = [&](const auto vertex) {
    const auto at = std::lower_bound(hull.vertices.begin(), hull.vertices.end(), unsorted[std::size_t{vertex}], before);
    return static_cast<std::uint32_t>(at - hull.vertices.begin());
  };
  for (const auto f : mesh.faces()) {
    std::vector<std::uint32_t> face;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) face.push_back(index(v));
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    hull.faces.push_back(std::move(face));
  }
  std::sort(hull.faces.begin(), hull.faces.end());
  return hull;
}

/// Distance of p, not inside, from the hull [m]. By triangles, not by planes: slivers have no usable plane.
double distance(const HullSurface& hull, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& f : hull.faces)
    least = std::min(least,
                     nearest_on_triangle(p, {hull.vertices[f[0]], hull.vertices[f[1]], hull.vertices[f[2]]}).distance);
  return least;
}

/// Vertices of triangles that are flat to within `tolerance`, and of pairs of triangles that are coplanar to within it.
std::vector<bool> suspects(const HullSurface& hull, double tolerance) {
  std::vector<bool> suspect(hull.vertices.size(), false);
  std::vector<std::array<std::uint32_t, 3>> edges;  // from, to, opposite
  for (const auto& f : hull.faces)
    for (std::size_t k = 0; k < 3; ++k) edges.push_back({f[k], f[(k + 1) % 3], f[(k + 2) % 3]});
  std::sort(edges.begin(), edges.end());
  for (const auto& [from, to, opposite] : edges) {
    const auto twin = std::lower_bound(edges.begin(), edges.end(), std::array{to, from, 0u});
    const Vec3 &a = hull.vertices[from], &b = hull.vertices[to], &c = hull.vertices[opposite];
    const Vec3 area = (b - a).cross(c - a);
    const bool thin = area.norm() <= tolerance * (b - a).norm();
    const bool coplanar = std::abs(area.dot(hull.vertices[(*twin)[2]] - a)) <= tolerance * area.norm();
    if (thin || coplanar) suspect[from] = suspect[to] = suspect[opposite] = suspect[(*twin)[2]] = true;
  }
  return suspect;
}

}  // namespace

HullSurface hull_from_points(std::span<const Vec3> points, const Place& place) {
  const auto distinct = sorted_distinct(points, place);
  if (distinct.size() < 4)
    throw SceneError("a polyhedron needs at least 4 distinct vertices, found " + std::to_string(distinct.size()),
                     place);
  const auto [length, width, height] = extents(distinct);
  if (!(height > flat * length))
    throw SceneError(std::string("the vertices of the polyhedron lie on one ") +
                         (width > flat * length ? "plane" : "line") + ": they enclose no volume",
                     place);
  HullSurface hull = exact_hull(distinct);
  // A point of a face that rounding has lifted by 1e-16 is a true vertex to exact predicates, and makes slivers without
  // a usable normal. It goes where the hull without it comes within 1e-12 of it.
  const double tolerance = redundant * length;
  const auto suspect = suspects(hull, tolerance);
  const auto candidates = hull.vertices;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (!suspect[k] || hull.vertices.size() <= 4) continue;
    auto others = hull.vertices;
    std::erase(others, candidates[k]);
    const auto rest = extents(others);
    if (!(rest[2] > flat * rest[0])) continue;
    HullSurface smaller = exact_hull(others);
    if (distance(smaller, candidates[k]) <= tolerance) hull = std::move(smaller);
  }
  return hull;
}

}  // namespace epafi
