#include "detection/narrow/axis_search.h"

#include <cmath>

namespace epafi {

using AxisKind = SeparatingAxis::Kind;

namespace {

std::vector<std::uint32_t>& deepest_of(std::size_t side) {
  static thread_local std::array<std::vector<std::uint32_t>, 2> deepest;
  return deepest[side];
}

std::vector<double>& heights_of(std::size_t side) {
  static thread_local std::array<std::vector<double>, 2>
      heights;  // keep their size: no allocation once the largest was seen
  return heights[side];
}

}  // namespace

double AxisSide::look_at(const Vec3& x) {
  height.resize(own.face_normals.size());
  double highest = -infinity;
  for (std::size_t f = 0; f < height.size(); ++f) {
    height[f] = own.face_normals[f].dot(x) - own.face_offsets[f];
    highest = std::max(highest, height[f]);
  }
  return highest;
}

std::uint32_t AxisSide::most_promising() const {
  std::uint32_t best = 0;
  double highest = -infinity;
  for (std::uint32_t f = 0; f < own.face_normals.size(); ++f) {
    const double h = own.face_normals[f].dot(other_centre) - own.face_offsets[f];
    if (h > highest) highest = h, best = f;
  }
  return best;
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
      side_a_{pair.a, pair.offset, pair.b.inner_radius, heights_of(0), deepest_of(0)},
      side_b_{pair.b, -(pair.rotation.transpose() * pair.offset), pair.a.inner_radius, heights_of(1), deepest_of(1)},
      tried_(pair) {
  side_a_.deepest.assign(pair.a.face_normals.size(), AxisSide::unknown);
  side_b_.deepest.assign(pair.b.face_normals.size(), AxisSide::unknown);
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
      side_a_.look_at(on_b), side_b_.look_at(from_b(on_a));
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
  side_a_.deepest[f] = pair_.support_b(pair_.a.face_normals[f]);
  tried_.try_face_a(f, side_a_.deepest[f]);
}

void AxisSearch::try_face_b(std::uint32_t f) {
  side_b_.deepest[f] = pair_.support_a(-(pair_.rotation * pair_.b.face_normals[f]));
  tried_.try_face_b(f, side_b_.deepest[f]);
}

void AxisSearch::try_faces() {
  const auto may_win = [&](const AxisSide& side, std::uint32_t f) {
    const double margin = tried_.margin();
    const double threshold = std::max(floor_, std::max(tried_.face().gap, tried_.edge().gap - margin)) - margin;
    return side.height[f] >= threshold && side.sphere_bound(f) >= threshold;
  };
  const auto known = [&](AxisKind kind, std::uint32_t f) {
    const SeparatingAxis& face = tried_.face();
    return face.kind == kind && f == (kind == AxisKind::face_a ? face.feature_a : face.feature_b);
  };
  for (std::uint32_t f = 0; f < pair_.a.face_normals.size(); ++f)
    if (may_win(side_a_, f) && !known(AxisKind::face_a, f)) try_face_a(f);
  for (std::uint32_t f = 0; f < pair_.b.face_normals.size(); ++f)
    if (may_win(side_b_, f) && !known(AxisKind::face_b, f)) try_face_b(f);
}

void AxisSearch::try_edges() {
  std::array<ArcEdge, chunk> held;
  const auto edges = static_cast<std::uint32_t>(pair_.a.edges.size());
  for (std::uint32_t k = 0; k < edges;) {
    std::uint32_t count = 0;
    const double threshold = tried_.edge_threshold(floor_);
    for (; k < edges && count < chunk; ++k)
      if (side_a_.edge_may_exceed(pair_.a.edges[k], threshold)) held[count++] = arc_of_a(pair_, k);
    if (count > 0) try_against({held.data(), count});
  }
}

void AxisSearch::try_against(std::span<const ArcEdge> held) {
  for (std::uint32_t k = 0; k < pair_.b.edges.size(); ++k) {
    if (!side_b_.edge_may_exceed(pair_.b.edges[k], tried_.edge_threshold(floor_))) continue;
    const ArcEdge other = arc_of_b(pair_, k);
    for (const ArcEdge& own : held)
      if (arcs_cross(own, other)) tried_.try_edges(own, other, floor_);
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

SeparatingAxis box_axis(const PolyhedronPair& pair) {
  const BoxFrame &a = *pair.a.box, &b = *pair.b.box;
  std::array<Vec3, 3> u, v;
  Vec3 t, tb;  // centre of B seen from that of A, along the axes of either
  Mat3 r, abs_r;
  const Vec3 between = pair.rotation * b.centre + pair.offset - a.centre;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    u[k] = pair.a.face_normals[a.face[k][1]], v[k] = pair.rotation * pair.b.face_normals[b.face[k][1]];
    t[i] = between.dot(u[k]), tb[i] = between.dot(v[k]);
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      r(i, j) = u[static_cast<std::size_t>(i)].dot(v[static_cast<std::size_t>(j)]), abs_r(i, j) = std::abs(r(i, j));
  SeparatingAxis best;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double on_a = std::abs(t[i]) - a.half[i] - abs_r.row(i).dot(b.half);
    if (on_a > best.gap) best = {AxisKind::face_a, on_a, t[i] > 0.0 ? u[k] : Vec3(-u[k]), a.face[k][t[i] > 0.0], 0};
    const double on_b = std::abs(tb[i]) - b.half[i] - abs_r.col(i).dot(a.half);
    if (on_b > best.gap) best = {AxisKind::face_b, on_b, tb[i] > 0.0 ? v[k] : Vec3(-v[k]), 0, b.face[k][tb[i] < 0.0]};
  }
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const double along = std::abs(t[i2] * r(i1, j) - t[i1] * r(i2, j)) - a.half[i1] * abs_r(i2, j) -
                           a.half[i2] * abs_r(i1, j) - b.half[j1] * abs_r(i, j2) - b.half[j2] * abs_r(i, j1);
      if (along < 0.0 && !(along > best.gap))
        continue;  // the length of the axis is at most 1: dividing lowers it further
      const double square = 1.0 - r(i, j) * r(i, j);
      if (!(square > 1e-9)) continue;  // nearly parallel: faces say the same
      const double gap = along / std::sqrt(square);
      if (!(gap > best.gap)) continue;
      Vec3 n = u[static_cast<std::size_t>(i)].cross(v[static_cast<std::size_t>(j)]);
      if (n.dot(between) < 0.0) n = -n;
      const auto edge_of = [](const BoxFrame& box, int axis, bool high1, bool high2) {
        return box.edge[static_cast<std::size_t>(axis)][2u * high1 + high2];
      };
      const auto along_u = [&](int k) { return n.dot(u[static_cast<std::size_t>(k)]) > 0.0; };
      const auto along_v = [&](int k) { return n.dot(v[static_cast<std::size_t>(k)]) < 0.0; };
      best = {AxisKind::edges, gap, n / std::sqrt(square), edge_of(a, i, along_u(i1), along_u(i2)),
              edge_of(b, j, along_v(j1), along_v(j2))};
    }
  }
  return best;
}

}  // namespace epafi
