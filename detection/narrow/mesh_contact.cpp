#include "detection/narrow/mesh_contact.h"

#include "detection/narrow/manifold.h"

namespace epafi {
namespace {

constexpr double same = 1e-6;  // the manifold's snap distance, and an angle no contact law can feel

bool is_parallel(const Vec3& m, const Vec3& n) { return (m - n).squaredNorm() <= same * same; }

}  // namespace

void reduce(std::vector<MeshPoint>& points, double size) {
  std::sort(points.begin(), points.end(), [](const MeshPoint& a, const MeshPoint& b) { return a.feature < b.feature; });
  std::size_t kept = 0;
  for (const MeshPoint& p : points) {
    const auto one = [&](const MeshPoint& o) {
      return o.feature == p.feature || (is_parallel(o.normal, p.normal) && (o.position - p.position).squaredNorm() <= same * same * size * size);
    };
    if (std::none_of(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(kept), one)) points[kept++] = p;
  }
  points.erase(points.begin() + static_cast<std::ptrdiff_t>(kept), points.end());
  if (kept <= 4) return;
  static thread_local std::vector<PatchPoint> group;  // keep their size: no allocation once the largest contact was seen
  static thread_local std::vector<MeshPoint> out;
  out.clear();
  for (std::size_t first = 0; first < kept; ++first) {
    const Vec3 n = points[first].normal;
    const auto is_earlier = [&](const MeshPoint& p) { return is_parallel(p.normal, n); };
    if (std::any_of(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(first), is_earlier)) continue;
    group.clear();
    for (std::size_t k = first; k < kept; ++k)
      if (is_parallel(points[k].normal, n)) group.push_back({points[k].position, points[k].gap, points[k].feature});
    Patch patch;
    keep_four(group, n, patch);
    for (int k = 0; k < patch.count; ++k) {
      const PatchPoint& p = patch.point[static_cast<std::size_t>(k)];
      out.push_back({p.position, n, p.gap, p.feature});
    }
  }
  points.assign(out.begin(), out.end());
}

void emit(std::span<const MeshPoint> points, const Vec3& body, double radius, const PairQuery& q, ContactSink& sink) {
  if (points.empty()) return;
  const Mat3 to_world = q.b.orientation.toRotationMatrix();
  for (const MeshPoint& p : points)
    sink.add({p.gap, -(to_world * p.normal), to_world * (p.position - body), q.curvature ? radius : 0.0, p.feature});
}

}  // namespace epafi
