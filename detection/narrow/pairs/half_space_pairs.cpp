#include "detection/narrow/pairs/half_space_pairs.h"

#include <algorithm>

#include "detection/narrow/polyhedra/overlap_cells.h"

namespace epafi {
namespace {

/// Keeps the vertices of faces towards the plane, and the deepest one: the far side of a thin slab is within reach too,
/// and the farthest of eight corners would be on it.
void keep_facing(const PolyhedronView& a, const Vec3& outward_in_a, std::vector<PatchPoint>& points) {
  static thread_local std::vector<char> faces_plane;
  faces_plane.assign(a.vertices.size(), 0);
  for (std::size_t f = 0; f < a.face_normals.size(); ++f) {
    if (!(a.face_normals[f].dot(outward_in_a) < -facing_cosine)) continue;
    for (std::uint32_t k = a.face_begin[f]; k < a.face_begin[f + 1]; ++k) faces_plane[a.face_vertices[k]] = 1;
  }
  const auto deepest = std::min_element(points.begin(), points.end(),
                                        [](const PatchPoint& p, const PatchPoint& q) { return p.gap < q.gap; });
  faces_plane[feature_vertex_a(deepest->feature)] = 1;
  std::erase_if(points, [](const PatchPoint& p) { return !faces_plane[feature_vertex_a(p.feature)]; });
}

}  // namespace

void collide_with_plane(const PolyhedronView& a, double sweep, double radius, const HalfSpace& b, const PairQuery& q,
                        ContactSink& sink) {
  static thread_local std::vector<PatchPoint> points;  // keeps its size: no allocation once the largest body was seen
  const Mat3 rotation = q.a.orientation.toRotationMatrix();
  const Vec3 outward = q.b.orientation * b.normal;
  const double centre = outward.dot(q.a.position - q.b.position);  // height of A's centre
  if (!(centre - a.radius - sweep < q.reach)) return;
  const Vec3 local = rotation.transpose() * outward;
  if (q.area) return collide_volume_with_plane(a, local, centre, rotation, radius, sink);
  points.clear();
  for (std::uint32_t v = 0; v < a.vertices.size(); ++v) {
    const double gap = centre + local.dot(a.vertices[v]) - sweep;
    if (!(gap < q.reach)) continue;
    points.push_back(
        {rotation * a.vertices[v] - (sweep + 0.5 * gap) * outward, gap, make_feature(FeatureKind::vertex_a, v, 0)});
  }
  if (q.reach > 0.0 && points.size() > 4) keep_facing(a, local, points);
  Patch patch;
  keep_corners(points, -outward, a.radius + sweep, !(q.reach > 0.0), patch);
  for (int k = 0; k < patch.count; ++k) {
    const PatchPoint& p = patch.point[static_cast<std::size_t>(k)];
    sink.add({p.gap, -outward, p.position, radius, p.feature});
  }
}

}  // namespace epafi
