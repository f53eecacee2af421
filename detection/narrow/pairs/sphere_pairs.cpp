#include "detection/narrow/pairs/sphere_pairs.h"

#include "detection/narrow/gjk/gjk.h"

namespace epafi {

void collide_closed(const Sphere& a, const ConvexHull& b, const PairQuery& q, ContactSink& sink) {
  const Mat3 to_world = q.b.orientation.toRotationMatrix();
  const Vec3 c = to_world.transpose() * (q.a.position - q.b.position);  // centre in the hull's axes
  const double reach = a.radius + b.sweep + q.reach;
  // The highest face plane: a lower bound of the distance, and the distance itself where the centre lies inside.
  double distance = -infinity;
  Vec3 outward = Vec3::UnitZ();
  for (std::size_t f = 0; f < b.face_normals.size(); ++f) {
    const double h = b.face_normals[f].dot(c) - b.face_offsets[f];
    if (h > distance) {
      distance = h;
      outward = b.face_normals[f];
    }
  }
  if (!(distance < reach)) return;
  if (distance > 0.0) {
    const Sphere point{};
    // The hull is "A" of this difference: its axes, no rotation of the support.
    const MinkowskiDifference difference(ConvexRef::to(b), ConvexRef::to(point), Mat3::Identity(), c);
    const GjkResult g = gjk(difference, {reach + 1e-12 * b.radius, 1e-15, outward});
    if (g.status == GjkResult::Status::beyond) return;
    if (g.status != GjkResult::Status::overlapping && g.lower > distance) {
      distance = g.lower;
      outward = g.normal;
    }
  }
  const double gap = distance - a.radius - b.sweep;
  if (!(gap < q.reach)) return;
  const Vec3 n = -(to_world * outward);
  sink.add({gap, n, a.radius * n, a.radius, 0});  // faces are flat
}

}  // namespace epafi
