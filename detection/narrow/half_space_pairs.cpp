#include "detection/narrow/half_space_pairs.h"

#include "detection/narrow/overlap_cells.h"

namespace epafi {

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
  Patch patch;
  keep_four(points, -outward, patch);
  for (int k = 0; k < patch.count; ++k) {
    const PatchPoint& p = patch.point[static_cast<std::size_t>(k)];
    sink.add({p.gap, -outward, p.position, radius, p.feature});
  }
}

}  // namespace epafi
