#include "detection/narrow/polyhedra/gauss_arcs.h"

#include <cmath>

namespace epafi {

using AxisKind = SeparatingAxis::Kind;

namespace {

// Sums of three products of lengths up to L round by some 1e-15 L.
constexpr double rounding = 2e-15;

}  // namespace

ArcEdge arc_of_a(const PolyhedronPair& pair, std::uint32_t k) {
  const HullEdge& edge = pair.a.edges[k];
  return {pair.a.vertices[edge.to] - pair.a.vertices[edge.from], pair.a.face_normals[edge.left],
          pair.a.face_normals[edge.right], k};
}

ArcEdge arc_of_b(const PolyhedronPair& pair, std::uint32_t k) {
  const HullEdge& edge = pair.b.edges[k];
  return {pair.rotation * (pair.b.vertices[edge.to] - pair.b.vertices[edge.from]),
          -(pair.rotation * pair.b.face_normals[edge.left]), -(pair.rotation * pair.b.face_normals[edge.right]), k};
}

bool arcs_may_cross(const ArcEdge& a, const ArcEdge& b, double turn) {
  const auto one_side = [](double left, double right, double slack) {
    return std::min(left, right) > slack || std::max(left, right) < -slack;
  };
  const double slack_a = turn * a.direction.norm(), slack_b = turn * b.direction.norm();
  return !one_side(a.direction.dot(b.left), a.direction.dot(b.right), slack_a) &&
         !one_side(b.direction.dot(a.left), b.direction.dot(a.right), slack_b);
}

AxisCandidates::AxisCandidates(const PolyhedronPair& pair)
    : pair_(pair), margin_(rounding * (pair.a.radius + pair.b.radius + pair.offset.cwiseAbs().maxCoeff())) {}

double AxisCandidates::try_face_a(std::uint32_t f, std::uint32_t v) {
  const Vec3& n = pair_.a.face_normals[f];
  const double gap = n.dot(pair_.vertex_b(v)) - pair_.a.face_offsets[f];
  const bool first = face_.kind != AxisKind::face_a || f < face_.feature_a;
  if (gap > face_.gap || (gap == face_.gap && first)) face_ = {AxisKind::face_a, gap, n, f, v};
  return gap;
}

double AxisCandidates::try_face_b(std::uint32_t f, std::uint32_t v) {
  const Vec3& m = pair_.b.face_normals[f];
  const Vec3 deepest = pair_.rotation.transpose() * (pair_.a.vertices[v] - pair_.offset);
  const double gap = m.dot(deepest) - pair_.b.face_offsets[f];
  const bool first = face_.kind == AxisKind::face_b && f < face_.feature_b;
  if (gap > face_.gap || (gap == face_.gap && first)) face_ = {AxisKind::face_b, gap, -(pair_.rotation * m), v, f};
  return gap;
}

void AxisCandidates::try_edges(const ArcEdge& own, const ArcEdge& other, double floor) {
  if (edge_.kind == AxisKind::edges && own.index == edge_.feature_a && other.index == edge_.feature_b) return;
  Vec3 n = own.direction.cross(other.direction);
  const double square = n.squaredNorm();
  if (!(square > 1e-30 * own.direction.squaredNorm() * other.direction.squaredNorm()))
    return;  // parallel: faces cover it
  n /= n.dot(own.left + own.right) < 0.0 ? -std::sqrt(square) : std::sqrt(square);
  const std::uint32_t from_a = pair_.a.edges[own.index].from, from_b = pair_.b.edges[other.index].from;
  const double along = n.dot(pair_.vertex_b(from_b) - pair_.a.vertices[from_a]);
  if (along < edge_threshold(floor)) return;
  // Where arcs only just cross, rounding may have chosen edges that do not support: the bodies themselves decide.
  // Climbing starts at the edges; if they do support, one step confirms it.
  const std::uint32_t top = ConvexHull::climb(pair_.a, n, from_a);
  const std::uint32_t low = ConvexHull::climb(pair_.b, -(pair_.rotation.transpose() * n), from_b);
  const double gap = std::min(along, n.dot(pair_.vertex_b(low) - pair_.a.vertices[top]));
  const bool first = std::pair(own.index, other.index) < std::pair(edge_.feature_a, edge_.feature_b);
  if (gap > edge_.gap || (gap == edge_.gap && first)) edge_ = {AxisKind::edges, gap, n, own.index, other.index};
}

}  // namespace epafi
