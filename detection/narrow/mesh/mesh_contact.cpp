#include "detection/narrow/mesh/mesh_contact.h"

#include <cmath>

#include "engine/state/frame.h"

namespace epafi {
namespace {

constexpr double same = 1e-6;  // the manifold's snap distance, and an angle no contact law can feel

/// Keeps the corners of the convex outline of the points seen along the normal (Andrew 1979), and the deepest point if
/// it is deeper. Points between corners, where a flat side crosses edges of the mesh, are dropped, so that the result
/// does not depend on the triangles.
void keep_outline(std::vector<PatchPoint>& points, const Vec3& normal, double tolerance) {
  if (points.size() <= 4) return;
  const ContactFrame frame = contact_frame(normal);
  const auto x = [&](const PatchPoint& p) { return frame.tangent1.dot(p.position); };
  const auto y = [&](const PatchPoint& p) { return frame.tangent2.dot(p.position); };
  const auto shallower = [](const PatchPoint& a, const PatchPoint& b) { return a.gap < b.gap; };
  const PatchPoint deepest = *std::min_element(points.begin(), points.end(), shallower);
  std::sort(points.begin(), points.end(),
            [&](const PatchPoint& a, const PatchPoint& b) { return std::pair(x(a), y(a)) < std::pair(x(b), y(b)); });
  static thread_local std::vector<PatchPoint> outline;  // keeps its size
  outline.clear();
  const auto chain = [&](const auto begin, const auto end) {
    const std::size_t base = outline.size();
    for (auto p = begin; p != end; ++p) {
      while (outline.size() >= base + 2) {  // the last corner goes where it lies right of, or on, the line past it
        const PatchPoint &a = outline[outline.size() - 2], &b = outline.back();
        const double ux = x(*p) - x(a), uy = y(*p) - y(a);
        if (ux * (y(b) - y(a)) - uy * (x(b) - x(a)) < -tolerance * std::sqrt(ux * ux + uy * uy)) break;
        outline.pop_back();
      }
      outline.push_back(*p);
    }
    outline.pop_back();  // the next chain begins with it
  };
  chain(points.begin(), points.end());
  chain(points.rbegin(), points.rend());
  const double least = std::min_element(outline.begin(), outline.end(), shallower)->gap;
  if (deepest.gap < least - tolerance) outline.push_back(deepest);
  points.assign(outline.begin(), outline.end());
}

}  // namespace

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
    if (std::none_of(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(kept), one)) points[kept++] = p;
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
    if (!springs || !corners) keep_outline(group, n, same * size);
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
