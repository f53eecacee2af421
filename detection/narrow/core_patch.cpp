#include "detection/narrow/core_patch.h"

#include <cmath>

namespace epafi {
namespace {

/// A point of the core's side and its name: a corner, or an edge of the side cut by an edge of the face.
struct SidePoint {
  Vec3 x;
  std::uint32_t corner, cut;  ///< cut: 1 + edge of the face; 0: the corner itself
};

std::uint32_t face_along(const PolyhedronView& p, const Vec3& n) {
  const std::uint32_t v = ConvexHull::support_vertex(p, n);
  std::uint32_t best = p.fans[p.fan_begin[v]];
  for (std::uint32_t k = p.fan_begin[v] + 1; k < p.fan_begin[v + 1]; ++k)
    if (p.face_normals[p.fans[k]].dot(n) > p.face_normals[best].dot(n)) best = p.fans[k];
  return best;
}

/// Cuts the side (2 corners: a segment, else a polygon) to the prism over the face (Sutherland and Hodgman 1974).
void clip_to_face(const PolyhedronView& p, std::uint32_t face, double tolerance, std::vector<SidePoint>& side) {
  static thread_local std::vector<SidePoint> next;  // keeps its size
  const std::uint32_t begin = p.face_begin[face], count = p.face_begin[face + 1] - begin;
  const bool segment = side.size() == 2;
  for (std::uint32_t k = 0; k < count && !side.empty(); ++k) {
    const Vec3& from = p.vertices[p.face_vertices[begin + k]];
    const Vec3 along = p.vertices[p.face_vertices[begin + (k + 1) % count]] - from;
    const Vec3 inward = p.face_normals[face].cross(along).normalized();
    next.clear();
    for (std::size_t i = 0; i < side.size(); ++i) {
      const SidePoint &a = side[i], &b = side[(i + 1) % side.size()];
      const double da = inward.dot(a.x - from), db = inward.dot(b.x - from);
      if (da >= -tolerance) next.push_back(a);
      if (segment && i == 1) break;  // a segment has no way back
      if ((da >= -tolerance) != (db >= -tolerance))
        next.push_back({a.x + std::clamp(da / (da - db), 0.0, 1.0) * (b.x - a.x), a.corner, 1 + k});
    }
    side.swap(next);
  }
}

}  // namespace

Patch core_patch(const CoreAndPolyhedron& pair, const NearestPoint& nearest, double reach, double sweep_polyhedron,
                 double sweep_core) {
  static thread_local std::vector<SidePoint> side;  // keep their size
  static thread_local std::vector<PatchPoint> points;
  side.clear(), points.clear();
  const PolyhedronView& p = pair.polyhedron;
  const Vec3& n = nearest.normal;
  const std::uint32_t face = face_along(p, n);
  const Vec3& m = p.face_normals[face];
  if (m.cross(n).squaredNorm() < facing_sine * facing_sine) {
    const FlatSide flat = pair.facing(pair.shape, -(pair.rotation.transpose() * n));
    for (int k = 0; k < flat.count; ++k)
      side.push_back(
          {pair.rotation * flat.corner[static_cast<std::size_t>(k)] + pair.offset, static_cast<std::uint32_t>(k), 0});
    clip_to_face(p, face, 1e-9 * p.radius, side);
  }
  double least = infinity;
  for (const SidePoint& s : side) {
    // never below the nearest: along a normal that is not the face's, a point beside the face may seem so
    const double gap =
        std::max(nearest.gap, (m.dot(s.x) - p.face_offsets[face]) / m.dot(n) - sweep_polyhedron - sweep_core);
    least = std::min(least, gap);
    if (!(gap < reach)) continue;
    const Feature name = s.cut == 0 ? make_feature(FeatureKind::vertex_b, 0, s.corner)
                                    : make_feature(FeatureKind::edges, s.cut, s.corner);
    points.push_back({s.x - (sweep_core + 0.5 * gap) * n, gap, name});
  }
  if (!(least <= nearest.gap + 1e-9 * p.radius))
    points.push_back({nearest.position, nearest.gap, make_feature(FeatureKind::single, 0, 0)});
  Patch out;
  keep_four(points, n, out);
  return out;
}

}  // namespace epafi
