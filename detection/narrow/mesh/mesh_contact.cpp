#include "detection/narrow/mesh/mesh_contact.h"

#include <cmath>

#include "detection/narrow/gjk/gjk.h"

namespace epafi {
namespace {

constexpr double same = 1e-6;  // the manifold's snap distance, and an angle no contact law can feel

}  // namespace

Vec3 nearest_of_hull(const Vec3& first, std::span<const Vec3> points) {
  Simplex nearest;
  nearest.count = 1;
  Vec3 place = nearest.vertex[0].y = first;
  const auto is_nearer = [&](const Vec3& v, const Vec3& w) { return v.dot(place) < w.dot(place); };
  bool around = false;
  for (std::size_t rounds = 0; rounds < 4 * points.size() && !around; ++rounds) {
    const Vec3& point = *std::ranges::min_element(points, is_nearer);
    if (point.dot(place) >= (1.0 - 1e-12) * place.squaredNorm()) break;
    nearest.vertex[static_cast<std::size_t>(nearest.count++)].y = point;
    place = closest_to_origin(nearest, around);
  }
  return place;
}

void drop_far(const TriangleMesh& mesh, const Vec3& x, double distance, std::size_t first,
              std::vector<std::uint32_t>& triangles) {
  const double far = distance * (1.0 + 1e-12);  // distances are rounded
  const auto is_far = [&](std::uint32_t t) {
    const OverTriangle at = over_triangle(mesh, t, x);
    if (at.least_square() > far * far) return true;
    if (at.beyond <= 0.0) return false;
    auto corner = mesh.corners(t);
    for (Vec3& c : corner) c -= x;
    return nearest_on_triangle(Vec3::Zero(), corner).distance > far;
  };
  triangles.erase(std::remove_if(triangles.begin() + static_cast<std::ptrdiff_t>(first), triangles.end(), is_far),
                  triangles.end());
}

void reduce(std::vector<MeshPoint>& points, double size, double flatness, bool springs) {
  const double angle = std::max(same, flatness / size);
  const auto is_parallel = [=](const Vec3& m, const Vec3& n) { return (m - n).squaredNorm() <= angle * angle; };
  // regions that share an edge give its points the same name: the deepest is kept
  std::sort(points.begin(), points.end(), [](const MeshPoint& a, const MeshPoint& b) {
    return a.feature != b.feature ? a.feature < b.feature : a.gap < b.gap;
  });
  std::size_t kept = 0;
  for (const MeshPoint& p : points) {
    const auto one = [&](const MeshPoint& o) {
      return o.feature == p.feature ||
             (is_parallel(o.normal, p.normal) && (o.position - p.position).squaredNorm() <= same * same * size * size);
    };
    const auto last = points.begin() + static_cast<std::ptrdiff_t>(kept);
    const auto known = std::find_if(points.begin(), last, one);
    if (known == last)
      points[kept++] = p;
    else
      known->gap = std::min(known->gap, p.gap);  // of a corner and the deepest point beside it
  }
  points.erase(points.begin() + static_cast<std::ptrdiff_t>(kept), points.end());
  if (kept <= 4) return;
  static thread_local std::vector<PatchPoint> group;  // they keep their sizes
  static thread_local std::vector<MeshPoint> out;
  out.clear();
  while (!points.empty()) {
    const Vec3 n = points.front().normal;
    group.clear();
    std::erase_if(points, [&](const MeshPoint& p) {
      if (!is_parallel(p.normal, n)) return false;
      group.push_back({p.position, p.gap, p.feature});
      return true;
    });
    const bool corners = std::ranges::all_of(group, is_corner_of_body, &PatchPoint::feature);
    Patch patch;
    keep_corners(group, n, size, springs && corners, patch);
    for (int k = 0; k < patch.count; ++k) {
      const PatchPoint& p = patch.point[static_cast<std::size_t>(k)];
      out.push_back({p.position, n, p.gap, p.feature});
    }
  }
  points.assign(out.begin(), out.end());
}

}  // namespace epafi
