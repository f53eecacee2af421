#include "detection/narrow/pairs/core_patch.h"

#include <cmath>

#include "detection/narrow/pairs/side_clip.h"

namespace epafi {
namespace {

std::uint32_t face_along(const PolyhedronView& p, const Vec3& n) {
  const std::uint32_t v = ConvexHull::support_vertex(p, n);
  std::uint32_t best = p.fans[p.fan_begin[v]];
  for (std::uint32_t k = p.fan_begin[v] + 1; k < p.fan_begin[v + 1]; ++k)
    if (p.face_normals[p.fans[k]].dot(n) > p.face_normals[best].dot(n)) best = p.fans[k];
  return best;
}

}  // namespace

Patch core_patch(const CoreAndPolyhedron& pair, const NearestPoint& nearest, double reach, double sweep_polyhedron,
                 double sweep_core) {
  static thread_local std::vector<SidePoint> side;  // keep their size
  static thread_local std::vector<PatchPoint> points;
  side.clear();
  points.clear();
  const PolyhedronView& p = pair.polyhedron;
  const Vec3& n = nearest.normal;
  const std::uint32_t face = face_along(p, n);
  const Vec3& m = p.face_normals[face];
  if (m.cross(n).squaredNorm() < facing_sine * facing_sine) {
    const FlatSide flat = pair.facing(pair.shape, -(pair.rotation.transpose() * n));
    for (int k = 0; k < flat.count; ++k)
      side.push_back(
          {pair.rotation * flat.corner[static_cast<std::size_t>(k)] + pair.offset, static_cast<std::uint32_t>(k), 0});
    const std::uint32_t begin = p.face_begin[face];
    clip_side([&](std::uint32_t k) -> const Vec3& { return p.vertices[p.face_vertices[begin + k]]; },
              p.face_begin[face + 1] - begin, m, side_snap * pair.size, side);
  }
  for (const SidePoint& s : side) {
    // never below the nearest: along a normal that is not the face's, a point beside the face may seem so
    const double gap =
        std::max(nearest.gap, (m.dot(s.x) - p.face_offsets[face]) / m.dot(n) - sweep_polyhedron - sweep_core);
    if (!(gap < reach)) continue;
    const Feature name = s.cut == 0 ? make_feature(FeatureKind::vertex_b, 0, s.corner)
                                    : make_feature(FeatureKind::edges, s.cut, s.corner);
    points.push_back({s.x - (sweep_core + 0.5 * gap) * n, gap, name});
  }
  Patch out;
  keep_with_nearest(points, nearest, pair.size, out);
  return out;
}

}  // namespace epafi
