#include "detection/narrow/polyhedra/resting_patch.h"

#include <cmath>

namespace epafi {
namespace {

using AxisKind = SeparatingAxis::Kind;
using Edge = std::array<std::uint32_t, 2>;  // vertices: from, to

/// The edge of a face that begins at a vertex; backwards: as a face seen from behind runs.
Edge edge_from(const PolyhedronView& p, std::uint32_t face, std::uint32_t vertex, bool backwards) {
  const std::uint32_t begin = p.face_begin[face], count = p.face_begin[face + 1] - begin;
  for (std::uint32_t k = 0; k < count; ++k)
    if (p.face_vertices[begin + k] == vertex)
      return {vertex, p.face_vertices[begin + (k + (backwards ? count - 1 : 1)) % count]};
  return {vertex, vertex};
}

Vec3 along_edge(const PolyhedronView& p, std::uint32_t from, std::uint32_t to) {
  return p.vertices[to] - p.vertices[from];
}

/// A crossing stays on A's edge u and goes with B's edge v: along u by (m.d) / (m.u), m across v. 0 where they are
/// nearly parallel.
struct Crossing {
  Vec3 u, m;
  Crossing(const PolyhedronPair& pair, const RestingPatch::Point& p, const Vec3& normal)
      : u(along_edge(pair.a, p.edge[0], p.edge[1])),
        m(normal.cross(pair.rotation * along_edge(pair.b, p.edge[2], p.edge[3]))) {
    const double along = m.dot(u);
    m *= std::abs(along) > 1e-3 * m.norm() * u.norm() ? 1.0 / along : 0.0;
  }
};

void place_on_edges(const PolyhedronView& a, const PolyhedronView& b, const Edge& ea, const Edge& eb,
                    RestingPatch::Point& p) {
  if (a.vertices.size() > 0xffff || b.vertices.size() > 0xffff) return;
  for (std::size_t k = 0; k < 2; ++k) {
    p.edge[k] = static_cast<std::uint16_t>(ea[k]);
    p.edge[2 + k] = static_cast<std::uint16_t>(eb[k]);
  }
}

Vec3 normal_now(const PolyhedronPair& pair, const RestingPatch& resting) {
  const auto kind = static_cast<AxisKind>(resting.kind);
  if (kind == AxisKind::face_a) return resting.normal;
  if (kind == AxisKind::face_b) return -(pair.rotation * pair.b.face_normals[resting.feature_b]);
  const HullEdge &a = pair.a.edges[resting.feature_a], &b = pair.b.edges[resting.feature_b];
  const Vec3 n = along_edge(pair.a, a.from, a.to).cross(pair.rotation * along_edge(pair.b, b.from, b.to)).normalized();
  return n.dot(resting.normal) > 0.0 ? n : Vec3(-n);
}

/// Where the pair's nearest point lies; false where parallel faces have it beside the axis' vertex.
bool place_alone(const PolyhedronPair& pair, const SeparatingAxis& axis, RestingPatch::Point& p) {
  p.on_a = axis.kind == AxisKind::face_b;
  p.on_b = axis.kind == AxisKind::face_a;
  if (axis.kind != AxisKind::edges) {
    const Vec3 x = p.on_a ? pair.a.vertices[axis.feature_a] : pair.vertex_b(axis.feature_b);
    return axis.normal.cross(p.position - x).norm() < 1e-9 * pair.size();
  }
  const HullEdge &a = pair.a.edges[axis.feature_a], &b = pair.b.edges[axis.feature_b];
  place_on_edges(pair.a, pair.b, {a.from, a.to}, {b.from, b.to}, p);
  return true;
}

/// Where a corner of the clipped faces lies, and how the planes of both slope there.
void place_corner(const PolyhedronPair& pair, const Patch& patch, const Vec3& n, RestingPatch::Point& p) {
  const Vec3 &na = pair.a.face_normals[patch.face_a], nb = pair.rotation * pair.b.face_normals[patch.face_b];
  const Vec3 over_a = na / na.dot(n), over_b = nb / nb.dot(n);
  const FeatureKind kind = feature_kind(p.feature);
  p.on_a = kind == FeatureKind::vertex_a;
  p.on_b = kind == FeatureKind::vertex_b;
  p.slope = p.on_b ? over_a : over_b;
  if (kind != FeatureKind::edges) return;
  place_on_edges(pair.a, pair.b, edge_from(pair.a, patch.face_a, feature_vertex_a(p.feature), false),
                 edge_from(pair.b, patch.face_b, feature_vertex_b(p.feature), true), p);
  const Crossing crossing(pair, p, n);
  p.slope += (over_a - over_b).dot(crossing.u) * crossing.m;
}

}  // namespace

void keep_resting(const PolyhedronPair& pair, const SeparatingAxis& axis, const Patch& patch, double reach,
                  RestingPatch& out) {
  out.count = 0;
  if (axis.kind == AxisKind::none || axis.kind == AxisKind::points) return;
  out.kind = static_cast<std::uint32_t>(axis.kind);
  out.feature_a = axis.feature_a;
  out.feature_b = axis.feature_b;
  out.reach = reach;
  out.rotation = pair.rotation;
  out.offset = pair.offset;
  out.normal = axis.normal;
  for (; out.count < static_cast<std::uint32_t>(patch.count); ++out.count) {
    const PatchPoint& from = patch.point[out.count];
    RestingPatch::Point& p = out.point[out.count] = {};
    p.position = from.position;
    p.slope = axis.normal;
    p.gap = from.gap;
    p.feature = from.feature;
    if (!patch.alone)
      place_corner(pair, patch, axis.normal, p);
    else if (!place_alone(pair, axis, p))
      return;
  }
}

bool recall_resting(const PolyhedronPair& pair, const RestingPatch& resting, double reach, Patch& out, Vec3& normal) {
  if (resting.count == 0 || reach > resting.reach) return false;
  const Mat3 turned = pair.rotation - resting.rotation;
  const Vec3 moved = pair.offset - resting.offset;
  // of two rotations R' - R stretches by at most its Frobenius norm over sqrt(2)
  const double way = moved.norm() + std::sqrt(0.5 * turned.squaredNorm()) * pair.b.radius;
  if (!(way <= still * std::min(pair.a.radius, pair.b.radius))) return false;
  const Mat3 turn = turned * resting.rotation.transpose();
  const Vec3& n = normal = normal_now(pair, resting);
  for (std::uint32_t k = 0; k < resting.count; ++k) {
    const RestingPatch::Point& p = resting.point[k];
    const Vec3 d = turn * (p.position - resting.offset) + moved;
    const double opened = p.slope.dot(d);
    if (!(p.gap + opened < reach)) return false;
    Vec3 x = p.position + (p.on_b ? -0.5 : 0.5) * opened * n;
    if (p.on_b) x += d;
    if (!p.on_a && !p.on_b) {
      const Crossing crossing(pair, p, n);
      x += crossing.m.dot(d) * crossing.u;
    }
    out.point[k] = {x, p.gap + opened, p.feature};
  }
  out.count = static_cast<int>(resting.count);
  return true;
}

}  // namespace epafi
