#include "detection/narrow/polyhedra/axis_search.h"

#include <cmath>

namespace epafi {

using AxisKind = SeparatingAxis::Kind;

namespace {

/// Of A and of B.
std::array<FaceArrays, 2>& face_arrays() {
  static thread_local std::array<FaceArrays, 2> arrays;
  return arrays;
}

}  // namespace

void FaceArrays::fit(const PolyhedronView& body) {
  const std::size_t faces = lane_count * body.face_lanes.size(), edges = lane_count * body.edge_lanes.size();
  if (point.size() < faces) {
    point.resize(faces);
    centre.resize(faces);
    deepest.resize(faces);
  }
  if (chosen.size() < std::max(faces, edges)) chosen.resize(std::max(faces, edges));
  std::fill_n(deepest.begin(), body.face_normals.size(), FaceHeights::unknown);
}

void AxisSide::look_at_centre() {
  if (!knows_centre) hull_kernels().heights(own.face_lanes, other_centre, face.centre.data());
  knows_centre = true;
}

std::uint32_t AxisSide::most_promising() {
  knows_centre = true;
  return hull_kernels().heights(own.face_lanes, other_centre, face.centre.data());
}

std::span<const std::uint32_t> AxisSide::promising_edges(double best) {
  // Heights above a face differ from those above its edges by what a hull's vertices may lie below its planes.
  const double slack = 4e-12 * own.radius;
  const std::size_t count =
      hull_kernels().promising_edges(own.edge_lanes, face, best, other_inner, slack, face.chosen.data());
  std::size_t kept = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t e = face.chosen[k];
    if (e < own.edges.size() && sphere_may_exceed(own.edges[e], best)) face.chosen[kept++] = e;
  }
  return {face.chosen.data(), kept};
}

/// separation(n) <= n.w - inner radius of the other, w from the edge to the other's centre; the largest n.w over
/// the arc is at an end or, where w projects into the arc, the length of that projection.
bool AxisSide::sphere_may_exceed(const HullEdge& edge, double best) const {
  const Vec3 w = other_centre - own.vertices[edge.from];
  const double needed = best + other_inner;
  const Vec3 &l = own.face_normals[edge.left], &r = own.face_normals[edge.right];
  const double wl = w.dot(l), wr = w.dot(r);
  if (std::max(wl, wr) >= needed || needed <= 0.0) return true;
  const double c = l.dot(r), slack = 1e-12 * own.radius;
  if (wl < c * wr - slack || wr < c * wl - slack) return false;
  const Vec3 e = own.vertices[edge.to] - own.vertices[edge.from];
  const double along = w.dot(e), square = e.squaredNorm();
  return (w.squaredNorm() - needed * needed) * square >= along * along * (1.0 - 1e-12);
}

AxisSearch::AxisSearch(const PolyhedronPair& pair)
    : pair_(pair),
      side_a_{pair.a, pair.offset, pair.b.inner_radius, face_arrays()[0]},
      side_b_{pair.b, -(pair.rotation.transpose() * pair.offset), pair.a.inner_radius, face_arrays()[1]},
      tried_(pair) {
  side_a_.face.fit(pair.a);
  side_b_.face.fit(pair.b);
}

void AxisSearch::start_from(const SeparatingAxis& axis) {
  if (axis.kind == AxisKind::face_a && axis.feature_a < pair_.a.face_normals.size()) try_face_a(axis.feature_a);
  if (axis.kind == AxisKind::face_b && axis.feature_b < pair_.b.face_normals.size()) try_face_b(axis.feature_b);
  if (axis.kind != AxisKind::edges || axis.feature_a >= pair_.a.edges.size() || axis.feature_b >= pair_.b.edges.size())
    return;
  const ArcEdge own = arc_of_a(pair_, axis.feature_a), other = arc_of_b(pair_, axis.feature_b);
  if (arcs_cross(own, other)) tried_.try_edges(own, other, floor_);
}

void AxisSearch::start_promising() {
  try_face_a(side_a_.most_promising());
  try_face_b(side_b_.most_promising());
}

SeparatingAxis AxisSearch::run(double floor) {
  floor_ = floor;
  if (!(best().gap > -infinity)) start_promising();
  look_at_deepest();
  const double before = best().gap;
  try_faces();
  if (best().gap > before) look_at_deepest();
  try_edges();
  return best().gap > floor ? best() : SeparatingAxis{};
}

/// Points of each body near the best axis so far: they prune what faces elsewhere.
void AxisSearch::look_at_deepest() {
  const SeparatingAxis& axis = best();
  const auto from_b = [&](const Vec3& x) -> Vec3 { return pair_.rotation.transpose() * (x - pair_.offset); };
  switch (axis.kind) {
    case AxisKind::edges: {
      Vec3 on_a, on_b;
      edge_points(pair_, axis.feature_a, axis.feature_b, axis.normal, on_a, on_b);
      side_a_.look_at(on_b);
      side_b_.look_at(from_b(on_a));
      return;
    }
    case AxisKind::face_a:  // B's vertex is a point of A as well where it is inside, a better one than A's own farthest
      if (side_a_.look_at(pair_.vertex_b(axis.feature_b)) <= 0.0)
        side_b_.look_at(pair_.b.vertices[axis.feature_b]);
      else
        side_b_.look_at(from_b(pair_.a.vertices[pair_.support_a(axis.normal)]));
      return;
    default:
      if (side_b_.look_at(from_b(pair_.a.vertices[axis.feature_a])) <= 0.0)
        side_a_.look_at(pair_.a.vertices[axis.feature_a]);
      else
        side_a_.look_at(pair_.vertex_b(pair_.support_b(axis.normal)));
  }
}

void AxisSearch::try_face_a(std::uint32_t f) {
  side_a_.face.deepest[f] = pair_.support_b(pair_.a.face_normals[f]);
  tried_.try_face_a(f, side_a_.face.deepest[f]);
}

void AxisSearch::try_face_b(std::uint32_t f) {
  side_b_.face.deepest[f] = pair_.support_a(-(pair_.rotation * pair_.b.face_normals[f]));
  tried_.try_face_b(f, side_b_.face.deepest[f]);
}

void AxisSearch::try_faces() {
  side_a_.look_at_centre();
  side_b_.look_at_centre();
  const auto threshold = [&] {
    const double margin = tried_.margin();
    return std::max(floor_, std::max(tried_.face().gap, tried_.edge().gap - margin)) - margin;
  };
  const auto try_each = [&](AxisSide& side, AxisKind kind, const auto& attempt) {
    const double least = threshold();
    std::uint32_t* chosen = side.face.chosen.data();
    const std::size_t count = hull_kernels().high_faces(side.face, side.own.face_normals.size(), least,
                                                        least + side.other_inner - tried_.margin(), chosen);
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t f = chosen[k];
      const SeparatingAxis& face = tried_.face();
      if (face.kind == kind && f == (kind == AxisKind::face_a ? face.feature_a : face.feature_b)) continue;
      if (side.face.point[f] >= threshold() && side.sphere_bound(f) >= threshold() - tried_.margin()) attempt(f);
    }
  };
  try_each(side_a_, AxisKind::face_a, [&](std::uint32_t f) { try_face_a(f); });
  try_each(side_b_, AxisKind::face_b, [&](std::uint32_t f) { try_face_b(f); });
}

void AxisSearch::try_edges() {
  const std::span<const std::uint32_t> promising = side_a_.promising_edges(tried_.edge_threshold(floor_));
  std::array<ArcLanes, chunk / lane_count> held;
  for (std::size_t begin = 0; begin < promising.size(); begin += chunk) {
    const auto names = promising.subspan(begin, std::min(chunk, promising.size() - begin));
    const std::size_t groups = (names.size() + lane_count - 1) / lane_count;
    held[groups - 1] = ArcLanes{};
    for (std::size_t k = 0; k < names.size(); ++k) {
      const HullEdge& e = pair_.a.edges[names[k]];
      const Vec3& from = pair_.a.vertices[e.from];
      held[k / lane_count].set(k % lane_count, {from, pair_.a.vertices[e.to] - from, pair_.a.face_normals[e.left],
                                                pair_.a.face_normals[e.right]});
    }
    try_against({held.data(), groups}, names);
  }
}

void AxisSearch::try_against(std::span<const ArcLanes> held, std::span<const std::uint32_t> names) {
  std::array<std::uint32_t, chunk> crossing;
  for (const std::uint32_t k : side_b_.promising_edges(tried_.edge_threshold(floor_))) {
    const ArcEdge other = arc_of_b(pair_, k);
    const Arc arc{pair_.vertex_b(pair_.b.edges[k].from), other.direction, other.left, other.right};
    const double least = tried_.edge_threshold(floor_) - 8.0 * tried_.margin();
    const std::size_t count = hull_kernels().crossing_arcs(held, arc, least, crossing.data());
    for (std::size_t i = 0; i < count; ++i) tried_.try_edges(arc_of_a(pair_, names[crossing[i]]), other, floor_);
  }
}

void edge_points(const PolyhedronPair& pair, std::uint32_t edge_a, std::uint32_t edge_b, const Vec3& normal, Vec3& on_a,
                 Vec3& on_b) {
  const HullEdge &ea = pair.a.edges[edge_a], &eb = pair.b.edges[edge_b];
  const Vec3 p = pair.a.vertices[ea.from], u = pair.a.vertices[ea.to] - p;
  const Vec3 q = pair.vertex_b(eb.from), v = pair.vertex_b(eb.to) - q;
  const auto parameter = [](const Vec3& from, const Vec3& along,
                            const Vec3& across) {  // across removes the other freedom
    const double slope = along.dot(across);
    return slope != 0.0 ? std::clamp(from.dot(across) / slope, 0.0, 1.0) : 0.5;
  };
  on_a = p + parameter(q - p, u, v.cross(normal)) * u;
  on_b = q + parameter(p - q, v, u.cross(normal)) * v;
}

}  // namespace epafi
