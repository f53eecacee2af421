#include "detection/narrow/polyhedra/polyhedra.h"

#include <cmath>

#include "detection/narrow/gjk/gjk_loop.h"
#include "detection/narrow/polyhedra/axis_search.h"
#include "detection/narrow/polyhedra/nearest_features.h"

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

/// The difference of two polyhedra with the supports in the loop.
struct PolyhedraDifference {
  const PolyhedronPair& pair;
  const Vec3& offset;
  MinkowskiVertex support(const Vec3& d) const {
    const std::uint32_t va = pair.support_a(d), vb = pair.support_b(d);
    const Vec3 on_a = pair.a.vertices[va], on_b = pair.vertex_b(vb);
    return {on_a - on_b, on_a, on_b, va, vb};
  }
  double size() const { return pair.size(); }
};

/// beside: how far off the face x may be [m].
bool over_face(const PolyhedronView& p, std::uint32_t f, const Vec3& x, double beside) {
  for (std::uint32_t k = p.face_begin[f], last = p.face_begin[f + 1] - 1, previous = last; k <= last; previous = k++) {
    const Vec3 &from = p.vertices[p.face_vertices[previous]], &to = p.vertices[p.face_vertices[k]];
    const Vec3 e = to - from;
    if (!(p.face_normals[f].dot(e.cross(x - from)) > -beside * e.cwiseAbs().sum())) return false;
  }
  return true;
}

/// The point of the axis' vertex lies over its face, not beside it.
bool over_own_face(const PolyhedronPair& pair, const SeparatingAxis& axis, double beside) {
  if (axis.kind == AxisKind::face_a) return over_face(pair.a, axis.feature_a, pair.vertex_b(axis.feature_b), beside);
  return over_face(pair.b, axis.feature_b, pair.rotation.transpose() * (pair.a.vertices[axis.feature_a] - pair.offset),
                   beside);
}

/// The separation along an axis is the distance where its points lie on the features, not beside them: then two points
/// are that far apart, and no two are nearer.
bool is_distance(const PolyhedronPair& pair, const SeparatingAxis& axis) {
  if (!(axis.gap > 0.0) || (axis.kind != AxisKind::face_a && axis.kind != AxisKind::face_b)) return false;
  return over_own_face(pair, axis, 0.0);
}

/// Of parallel faces the deepest vertex is any of the one's, and its foot may lie beside the other: the nearest points
/// of the bodies with B pushed out along the axis and a little further lie on both.
void push_apart(const PolyhedronPair& pair, PolyhedronDistance& d) {
  PolyhedronPair apart = pair;
  apart.offset += (1e-3 * pair.size() - d.axis.gap) * d.axis.normal;
  const GjkResult g = gjk_detail::run(PolyhedraDifference{apart, apart.offset}, {infinity, 1e-15, d.axis.normal});
  if (g.status == GjkResult::Status::overlapping) return;
  d.witness_a = g.witness_a;
  d.witness_b = g.witness_a + d.axis.gap * d.axis.normal;
}

PolyhedronDistance at_axis(const PolyhedronPair& pair, const SeparatingAxis& axis, double limit) {
  PolyhedronDistance d;
  d.axis = axis;
  axis_witnesses(pair, d);
  d.beyond = axis.gap > limit;
  const bool face = axis.kind == AxisKind::face_a || axis.kind == AxisKind::face_b;
  const double size = pair.size();
  if (!d.beyond && face && axis.gap < 1e-6 * size && !over_own_face(pair, axis, 1e-9 * size)) push_apart(pair, d);
  return d;
}

/// Overlap by more than rounding is certain, by any method.
double certain_overlap(const PolyhedronPair& pair) { return -1e-14 * (pair.a.radius + pair.b.radius); }

NearestFeatures features_at(const SeparatingAxis& axis) {
  using Kind = NearestFeatures::Kind;
  const Kind kind = axis.kind == AxisKind::face_a   ? Kind::face_vertex
                    : axis.kind == AxisKind::face_b ? Kind::vertex_face
                    : axis.kind == AxisKind::edges  ? Kind::edges
                                                    : Kind::none;
  return {kind, axis.feature_a, axis.feature_b};
}

/// The answer from the features remembered, where they are certified to give it.
bool recall(const PolyhedronPair& pair, double limit, PairMemory& memory, PolyhedronDistance& out) {
  bool found = certify(pair, memory.nearest, out);
  SeparatingAxis axis;
  if (!found && recall_axis(pair, memory.reference, axis)) {
    if (axis.gap < certain_overlap(pair)) {
      out = at_axis(pair, axis, limit);
      found = true;
    } else {
      const NearestFeatures nearest = features_at(axis);
      found = certify(pair, nearest, out);
      if (found) memory.nearest = nearest;
    }
    if (found && memory.uses < 255) ++memory.uses;
  }
  if (found) out.beyond = out.axis.gap > limit;
  return found;
}

/// GJK from the last direction. Only certified features are used, since other results depend on the start.
bool follow(const PolyhedronPair& pair, double limit, PairMemory& memory, PolyhedronDistance& out) {
  if (memory.nearest.kind == NearestFeatures::Kind::none) return false;
  const GjkResult g = gjk_detail::run(PolyhedraDifference{pair, pair.offset}, {infinity, 1e-15, memory.normal});
  NearestFeatures nearest;
  if (g.status == GjkResult::Status::overlapping || !find_nearest_features(pair, g, nearest, out)) return false;
  memory.nearest = nearest;
  memory.normal = out.axis.normal;
  out.beyond = out.axis.gap > limit;
  return true;
}

/// A reference costs about as much as a search; for a pair that moves too fast to use it, or has too many equal
/// features, the wait is doubled each time.
void make_reference(const PolyhedronPair& pair, const SeparatingAxis& axis, PairMemory& memory) {
  if (memory.wait > 0) {
    --memory.wait;
    return;
  }
  constexpr int worth = 4, longest = 31;
  const bool useless = memory.tried && memory.uses < worth;
  memory.patience = static_cast<std::uint8_t>(useless ? std::min(2 * memory.patience + 1, longest) : 0);
  memory.wait = memory.patience;
  memory.uses = 0;
  memory.tried = true;
  // Of the smaller body: a reference lasts for relative motion of half its range. The narrower one has fewer features.
  for (const double range : {0.02, 0.006}) {
    AxisSearch search(pair);
    search.start_from(axis);
    search.keep(range * std::min(pair.a.radius, pair.b.radius), memory.reference);
    if (memory.reference.known) return;
  }
}

void remember(const PolyhedronPair& pair, const PolyhedronDistance& d, PairMemory& memory) {
  const bool seen = memory.kind != 0;
  memory.kind = static_cast<std::uint8_t>(d.axis.kind);
  memory.feature_a = d.axis.feature_a;
  memory.feature_b = d.axis.feature_b;
  memory.normal = d.axis.normal;
  if (seen && d.axis.gap < certain_overlap(pair) && d.axis.kind != AxisKind::points)
    make_reference(pair, d.axis, memory);
}

/// GJK from a direction; where the pair is closer than it can tell, what search() finds over the features.
template <class Search>
PolyhedronDistance distance_by_gjk(const PolyhedronPair& pair, double limit, const Vec3& direction,
                                   NearestFeatures& nearest, const Search& search) {
  const GjkResult g =
      gjk_detail::run(PolyhedraDifference{pair, pair.offset}, {limit + 1e-12 * pair.size(), 1e-15, direction});
  PolyhedronDistance d;
  d.axis = {AxisKind::points, g.lower, g.normal, 0, 0};
  d.uncertainty = g.upper - g.lower;
  d.beyond = g.status == GjkResult::Status::beyond;
  if (d.beyond) return d;
  d.witness_a = g.witness_a;
  d.witness_b = g.witness_b;
  const bool separated = g.status == GjkResult::Status::separated, apart = g.status == GjkResult::Status::capped;
  PolyhedronDistance certified;
  if ((separated || apart) && find_nearest_features(pair, g, nearest, certified)) {
    certified.beyond = certified.axis.gap > limit;
    return certified;
  }
  nearest.kind = NearestFeatures::Kind::none;
  if (separated) return d;
  // Closer than GJK can tell: the features decide. Apart, they may still not exceed what GJK certified.
  const SeparatingAxis found = search();
  if (found.gap < certain_overlap(pair)) return at_axis(pair, found, limit);
  nearest = features_at(found);
  if (certify(pair, nearest, certified)) {
    certified.beyond = certified.axis.gap > limit;
    return certified;
  }
  nearest.kind = NearestFeatures::Kind::none;
  if (apart && !(found.gap > g.lower)) return d;
  d = at_axis(pair, found, limit);
  d.uncertainty = apart ? std::max(0.0, g.upper - found.gap) : 0.0;
  return d;
}

/// The search without memory. start: an axis of an earlier pose, which does not affect the result. nearest: the
/// features of the closest points, where they are certified.
PolyhedronDistance search_distance(const PolyhedronPair& pair, double limit, const SeparatingAxis& start,
                                   NearestFeatures& nearest) {
  const double certain = certain_overlap(pair);
  // Overlapping: the search over features decides, for every start. Everything else is decided below, without memory.
  SeparatingAxis found;
  bool searched = start.kind != AxisKind::none && start.kind != AxisKind::points;
  if (searched) {
    found = separating_axis(pair, start);
    if (found.gap < certain) return at_axis(pair, found, limit);
  }
  AxisSearch search(pair);
  BoxAxis boxes;
  if (pair.a.box && pair.b.box)
    search.start_from((boxes = box_axis(pair)).axis);
  else
    search.start_promising();
  const SeparatingAxis first = search.best();
  if (boxes.alone && first.kind == boxes.axis.kind && first.gap < certain) return at_axis(pair, first, limit);
  if (first.gap > limit + 1e-12 * pair.size()) return at_axis(pair, first, limit);
  if (is_distance(pair, first)) {
    nearest = features_at(first);
    return at_axis(pair, first, limit);
  }

  // Pairs that were separated try GJK first, others the features. Both orders give the same: GJK certifies a distance
  // exactly if no search finds an overlap.
  if (!searched && first.gap < 0.0 && start.kind != AxisKind::points) {
    found = search.run();
    searched = true;
    if (found.gap < certain) return at_axis(pair, found, limit);
  }
  return distance_by_gjk(pair, limit, first.normal, nearest, [&] { return searched ? found : search.run(); });
}

}  // namespace

PolyhedronDistance axis_distance(const PolyhedronPair& pair) { return at_axis(pair, separating_axis(pair), infinity); }

PolyhedronDistance polyhedron_distance(const PolyhedronPair& pair, double limit, PairMemory* memory) {
  PolyhedronDistance d;
  NearestFeatures nearest;
  if (!memory) return search_distance(pair, limit, {}, nearest);
  if (recall(pair, limit, *memory, d) || follow(pair, limit, *memory, d)) return d;
  SeparatingAxis start;
  start.kind = static_cast<AxisKind>(memory->kind);
  start.feature_a = memory->feature_a;
  start.feature_b = memory->feature_b;
  d = search_distance(pair, limit, start, nearest);
  if (nearest.kind != NearestFeatures::Kind::none) memory->nearest = nearest;
  remember(pair, d, *memory);
  return d;
}

}  // namespace epafi
