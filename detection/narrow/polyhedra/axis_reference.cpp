// AxisSearch::keep and recall_axis: the few features that can hold the best axis while the bodies move little.
// For a fixed direction in A's axes the separation changes by at most the motion of B's points relative to A, and
// likewise with exchanged bodies: |R' - R| r + |o' - o|. Features below the threshold by that much need no test.
#include <cmath>

#include "detection/narrow/polyhedra/axis_search.h"

namespace epafi {
namespace {

/// Does some direction over the arc between the normals l and r separate by more than the threshold (< 0)? e: a point
/// of the edge. deepest(n): the other body's deepest point along n. Of two points the separation is at most the smaller
/// height; over the arc that is largest where they are equal, so the arc is halved there.
template <class Deepest>
bool arc_exceeds(const Vec3& l, const Vec3& on_l, const Vec3& r, const Vec3& on_r, const Vec3& e, double threshold,
                 const Deepest& deepest, int depth = 0) {
  if (std::max(l.dot(on_l - e), r.dot(on_r - e)) > threshold) return true;
  const Vec3 w = on_l - on_r;
  const double share_l = r.dot(w), share_r = -l.dot(w);
  if (!(share_l > 0.0) || !(share_r > 0.0)) return false;  // one point is the lower over the whole arc
  const Vec3 n = (share_l * l + share_r * r).normalized();
  if (!(n.dot(on_l - e) > threshold)) return false;
  const Vec3 x = deepest(n);
  if (n.dot(x - e) > threshold || depth == 4) return true;
  return arc_exceeds(l, on_l, n, x, e, threshold, deepest, depth + 1) ||
         arc_exceeds(n, x, r, on_r, e, threshold, deepest, depth + 1);
}

constexpr std::uint32_t largest_index = 0xffffu;
constexpr std::size_t most_edges = 16;  // of each body; more: the pair is too even for a short list

/// True if the vertex remains the deepest along d for rotations up to `turn`: against every neighbour, so against all.
bool stays_deepest(const PolyhedronView& p, const Vec3& d, std::uint32_t v, double turn) {
  for (std::uint32_t k = p.neighbour_begin[v]; k < p.neighbour_begin[v + 1]; ++k) {
    const Vec3 away = p.vertices[v] - p.vertices[p.neighbours[k]];
    if (!(d.dot(away) > turn * away.norm())) return false;
  }
  return true;
}

/// Edges of one body whose arcs exceed the threshold, or may after turning by `turn`; false where they are too many.
/// support(n): the other body's deepest vertex along n. stays(n, v): it stays so. place: of that vertex.
template <class Support, class Stays, class Place>
bool collect_edges(const AxisSide& side, double threshold, const Support& support, const Stays& stays,
                   const Place& place, std::array<std::uint32_t, most_edges>& out, std::size_t& count) {
  const auto deepest = [&](const Vec3& n) -> Vec3 { return place(support(n)); };
  count = 0;
  for (std::uint32_t k = 0; k < side.own.edges.size(); ++k) {
    const HullEdge& edge = side.own.edges[k];
    const Vec3 &l = side.own.face_normals[edge.left], &r = side.own.face_normals[edge.right];
    if (!(std::max(side.face.point[edge.left], side.face.point[edge.right]) > threshold)) continue;
    if (!side.sphere_may_exceed(edge, threshold)) continue;
    // One vertex deepest below both faces, now and later: no direction between them is better than these two.
    const std::uint32_t below_l = side.face.deepest[edge.left], below_r = side.face.deepest[edge.right];
    if (below_l == below_r && below_l != AxisSide::unknown && stays(l, below_l) && stays(r, below_r)) continue;
    if (!arc_exceeds(l, deepest(l), r, deepest(r), side.own.vertices[edge.from], threshold, deepest)) continue;
    if (count == most_edges) return false;
    out[count++] = k;
  }
  return true;
}

/// The deepest vertex, as a search finds it: from the one remembered where no neighbour is as deep, to rounding.
std::uint32_t deepest_vertex(const PolyhedronView& p, const Vec3& d, std::uint32_t remembered, double margin) {
  const std::uint32_t v = ConvexHull::climb(p, d, remembered);
  const double height = d.dot(p.vertices[v]) - 4.0 * margin;
  for (std::uint32_t k = p.neighbour_begin[v]; k < p.neighbour_begin[v + 1]; ++k)
    if (!(d.dot(p.vertices[p.neighbours[k]]) < height)) return ConvexHull::support_vertex(p, d);
  return v;
}

}  // namespace

bool AxisSearch::keep_faces(double threshold, AxisReference& out) {
  const auto collect = [&](AxisSide& side, auto& list, std::uint8_t& count, const auto& separation) {
    count = 0;
    for (std::uint32_t f = 0; f < side.own.face_normals.size(); ++f) {
      if (!(side.face.point[f] > threshold) || !(side.sphere_bound(f) > threshold)) continue;
      if (!(separation(f) > threshold)) continue;
      if (count == AxisReference::most_faces) return false;
      list[count++] = {static_cast<std::uint16_t>(f), static_cast<std::uint16_t>(side.face.deepest[f])};
    }
    return true;
  };
  const auto on_a = [&](std::uint32_t f) {
    side_a_.face.deepest[f] = pair_.support_b(pair_.a.face_normals[f]);
    return tried_.try_face_a(f, side_a_.face.deepest[f]);
  };
  const auto on_b = [&](std::uint32_t f) {
    side_b_.face.deepest[f] = pair_.support_a(-(pair_.rotation * pair_.b.face_normals[f]));
    return tried_.try_face_b(f, side_b_.face.deepest[f]);
  };
  return collect(side_a_, out.face_a, out.faces_a, on_a) && collect(side_b_, out.face_b, out.faces_b, on_b);
}

bool AxisSearch::keep_crossings(double threshold, AxisReference& out) {
  std::array<std::uint32_t, most_edges> of_a, of_b;
  std::size_t count_a = 0, count_b = 0;
  const auto below_a = [&](const Vec3& n) { return pair_.support_b(n); };
  const auto below_b = [&](const Vec3& m) { return pair_.support_a(-(pair_.rotation * m)); };
  const auto of_vertex_b = [&](std::uint32_t v) { return pair_.vertex_b(v); };
  const auto of_vertex_a = [&](std::uint32_t v) -> Vec3 {
    return pair_.rotation.transpose() * (pair_.a.vertices[v] - pair_.offset);
  };
  const auto b_stays = [&](const Vec3& n, std::uint32_t v) {
    return stays_deepest(pair_.b, -(pair_.rotation.transpose() * n), v, out.turn);
  };
  const auto a_stays = [&](const Vec3& m, std::uint32_t v) {
    return stays_deepest(pair_.a, -(pair_.rotation * m), v, out.turn);
  };
  if (!collect_edges(side_a_, threshold, below_a, b_stays, of_vertex_b, of_a, count_a)) return false;
  out.crossings = 0;
  if (count_a == 0) return true;
  if (!collect_edges(side_b_, threshold, below_b, a_stays, of_vertex_a, of_b, count_b)) return false;
  for (std::size_t j = 0; j < count_b; ++j) {
    const ArcEdge other = arc_of_b(pair_, of_b[j]);
    for (std::size_t i = 0; i < count_a; ++i) {
      if (!arcs_may_cross(arc_of_a(pair_, of_a[i]), other, out.turn)) continue;
      if (out.crossings == AxisReference::most_crossings) return false;
      out.crossing[out.crossings++] = {static_cast<std::uint16_t>(of_a[i]), static_cast<std::uint16_t>(of_b[j])};
    }
  }
  return true;
}

void AxisSearch::keep(double range, AxisReference& out) {
  out.known = false;
  const double threshold = best().gap - range;
  const auto fits = [](const PolyhedronView& p) { return p.vertices.size() + p.edges.size() < largest_index; };
  if (!(best().gap < 0.0) || !fits(pair_.a) || !fits(pair_.b)) return;
  look_at_deepest();
  side_a_.look_at_centre();
  side_b_.look_at_centre();
  out.threshold = threshold;
  out.turn = range / std::max(pair_.a.radius, pair_.b.radius);
  out.rotation = pair_.rotation;
  out.offset = pair_.offset;
  out.offset_b = pair_.rotation.transpose() * pair_.offset;
  out.known = keep_faces(threshold, out) && keep_crossings(threshold, out);
}

bool recall_axis(const PolyhedronPair& pair, const AxisReference& reference, SeparatingAxis& out) {
  if (!reference.known) return false;
  // Of two rotations R' - R stretches by at most its Frobenius norm over sqrt(2).
  const double turned = std::sqrt(0.5 * (pair.rotation - reference.rotation).squaredNorm());
  if (!(turned < reference.turn)) return false;
  AxisCandidates tried(pair);
  const Mat3 back = pair.rotation.transpose();
  const double margin = tried.margin();
  for (std::size_t k = 0; k < reference.faces_a; ++k) {
    const auto [f, v] = reference.face_a[k];
    tried.try_face_a(f, deepest_vertex(pair.b, -(back * pair.a.face_normals[f]), v, margin));
  }
  for (std::size_t k = 0; k < reference.faces_b; ++k) {
    const auto [f, v] = reference.face_b[k];
    tried.try_face_b(f, deepest_vertex(pair.a, -(pair.rotation * pair.b.face_normals[f]), v, margin));
  }
  ArcEdge other;
  for (std::size_t k = 0; k < reference.crossings; ++k) {
    const auto [i, j] = reference.crossing[k];
    if (k == 0 || j != other.index) other = arc_of_b(pair, j);
    const ArcEdge own = arc_of_a(pair, i);
    if (arcs_cross(own, other)) tried.try_edges(own, other);
  }
  const double moved_a = turned * pair.b.radius + (pair.offset - reference.offset).norm();
  const double moved_b = turned * pair.a.radius + (back * pair.offset - reference.offset_b).norm();
  out = tried.best();
  return out.gap - 8.0 * margin > reference.threshold + std::max(moved_a, moved_b);
}

}  // namespace epafi
