#include "detection/narrow/polyhedra.h"

#include <cmath>

#include "detection/narrow/axis_search.h"
#include "detection/narrow/gjk_loop.h"

namespace epafi {
namespace {

void axis_witnesses(const PolyhedronPair& pair, PolyhedronDistance& d) {
  switch (d.axis.kind) {
    case SeparatingAxis::Kind::edges:
      edge_points(pair, d.axis.feature_a, d.axis.feature_b, d.axis.normal, d.witness_a, d.witness_b);
      d.witness_b = d.witness_a + d.axis.gap * d.axis.normal;
      return;
    case SeparatingAxis::Kind::face_b:
      d.witness_a = pair.a.vertices[d.axis.feature_a];
      d.witness_b = d.witness_a + d.axis.gap * d.axis.normal;
      return;
    default:
      d.witness_b = pair.vertex_b(d.axis.feature_b);
      d.witness_a = d.witness_b - d.axis.gap * d.axis.normal;
  }
}

}  // namespace

PolyhedronPair::PolyhedronPair(const PolyhedronView& view_a, const PolyhedronView& view_b, const Pose& pose_a,
                               const Pose& pose_b)
    : a(view_a), b(view_b) {
  const Mat3 to_a = pose_a.orientation.toRotationMatrix().transpose();
  rotation = to_a * pose_b.orientation.toRotationMatrix();
  offset = to_a * (pose_b.position - pose_a.position);
}

SeparatingAxis separating_axis(const PolyhedronPair& pair, const SeparatingAxis& start) {
  AxisSearch search(pair);
  search.start_from(start);
  return search.run();
}

namespace {

using AxisKind = SeparatingAxis::Kind;

PolyhedronDistance at_axis(const PolyhedronPair& pair, const SeparatingAxis& axis, double limit) {
  PolyhedronDistance d;
  d.axis = axis;
  axis_witnesses(pair, d);
  d.beyond = axis.gap > limit;
  return d;
}

/// The difference of two polyhedra with the supports in the loop.
struct PolyhedraDifference {
  const PolyhedronPair& pair;
  const Vec3& offset;
  MinkowskiVertex support(const Vec3& d) const {
    const Vec3 on_a = pair.a.vertices[pair.support_a(d)], on_b = pair.vertex_b(pair.support_b(d));
    return {on_a - on_b, on_a, on_b};
  }
  double size() const { return pair.size(); }
};

/// The separation along an axis is the distance where its points lie on the features, not beside them: then two points
/// are that far apart, and no two are nearer.
bool is_distance(const PolyhedronPair& pair, const SeparatingAxis& axis) {
  const auto over_face = [](const PolyhedronView& p, std::uint32_t f, const Vec3& x) {
    for (std::uint32_t k = p.face_begin[f], last = p.face_begin[f + 1] - 1, previous = last; k <= last;
         previous = k++) {
      const Vec3 &from = p.vertices[p.face_vertices[previous]], &to = p.vertices[p.face_vertices[k]];
      if (!(p.face_normals[f].dot((to - from).cross(x - from)) > 0.0)) return false;
    }
    return true;
  };
  if (!(axis.gap > 0.0)) return false;
  if (axis.kind == AxisKind::face_a) return over_face(pair.a, axis.feature_a, pair.vertex_b(axis.feature_b));
  if (axis.kind != AxisKind::face_b) return false;
  return over_face(pair.b, axis.feature_b, pair.rotation.transpose() * (pair.a.vertices[axis.feature_a] - pair.offset));
}

}  // namespace

PolyhedronDistance axis_distance(const PolyhedronPair& pair) { return at_axis(pair, separating_axis(pair), infinity); }

PolyhedronDistance polyhedron_distance(const PolyhedronPair& pair, double limit, const SeparatingAxis& start) {
  // Overlapping by more than rounding is certain whoever finds it: the search over features then has the last word,
  // whatever it began with. Everything else is decided below, from the beginning.
  const double certain = -1e-14 * (pair.a.radius + pair.b.radius);
  SeparatingAxis found;
  bool searched = start.kind != AxisKind::none && start.kind != AxisKind::points;
  if (searched) {
    found = separating_axis(pair, start);
    if (found.gap < certain) return at_axis(pair, found, limit);
  }
  AxisSearch search(pair);
  if (pair.a.box && pair.b.box)
    search.start_from(box_axis(pair));
  else
    search.start_promising();
  const SeparatingAxis first = search.best();
  if (first.gap > limit + 1e-12 * pair.size() || is_distance(pair, first)) return at_axis(pair, first, limit);

  // A pair that was apart asks GJK first, any other the features. Both orders end alike: GJK certifies a distance
  // exactly where no search finds an overlap.
  if (!searched && first.gap < 0.0 && start.kind != AxisKind::points) {
    found = search.run(), searched = true;
    if (found.gap < certain) return at_axis(pair, found, limit);
  }
  const GjkResult g =
      gjk_detail::run(PolyhedraDifference{pair, pair.offset}, {limit + 1e-12 * pair.size(), 1e-15, first.normal});
  PolyhedronDistance d;
  d.axis = {AxisKind::points, g.lower, g.normal, 0, 0};
  d.uncertainty = g.upper - g.lower;
  d.beyond = g.status == GjkResult::Status::beyond;
  if (d.beyond) return d;
  d.witness_a = g.witness_a, d.witness_b = g.witness_b;
  if (g.status == GjkResult::Status::separated) return d;
  // Closer than GJK can tell: the features decide. Apart, they may still not exceed what GJK certified.
  const bool apart = g.status == GjkResult::Status::capped;
  if (!searched) found = search.run();
  if (found.gap < certain) return at_axis(pair, found, limit);
  if (apart && !(found.gap > g.lower)) return d;
  d = at_axis(pair, found, limit);
  d.uncertainty = apart ? std::max(0.0, g.upper - found.gap) : 0.0;
  return d;
}

}  // namespace epafi
