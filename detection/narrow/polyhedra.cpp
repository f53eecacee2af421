#include "detection/narrow/polyhedra.h"

#include <cmath>

namespace epafi {
namespace {

/// An edge whose arc on the Gauss sphere may hold the best axis. All in A's axes; B's normals are negated.
struct ArcEdge {
  Vec3 direction, left, right;
  std::uint32_t index;
};

/// One polyhedron seen from its own axes: where the other's centre is and how large a sphere the other surely fills.
struct Side {
  const PolyhedronView& own;
  Vec3 other_centre;
  double other_inner;

  /// No direction n normal to this face can separate by more than this.
  double face_bound(std::uint32_t f) const { return own.face_normals[f].dot(other_centre) - own.face_offsets[f] - other_inner; }

  /// Can some direction between the normals of the edge's faces separate by more than `best`?
  /// separation(n) <= n.w - inner radius of the other, w from the edge to the other's centre; the largest n.w over
  /// the arc is at an end or, where w projects into the arc, the length of that projection.
  bool edge_may_exceed(const HullEdge& edge, double best) const {
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
};

class AxisSearch {
 public:
  AxisSearch(const PolyhedronPair& pair, double limit, const SeparatingAxis& start)
      : pair_(pair), side_a_{pair.a, pair.offset, pair.b.inner_radius},
        side_b_{pair.b, -(pair.rotation.transpose() * pair.offset), pair.a.inner_radius}, limit_(limit), best_(start) {}

  SeparatingAxis run() {
    try_best_faces();
    if (best_.gap > limit_) return best_;
    for (std::uint32_t f = 0; f < pair_.a.face_normals.size(); ++f) {
      if (side_a_.face_bound(f) > best_.gap) try_face_a(f);
    }
    for (std::uint32_t f = 0; f < pair_.b.face_normals.size(); ++f) {
      if (side_b_.face_bound(f) > best_.gap) try_face_b(f);
    }
    if (best_.gap <= limit_) try_edges();
    return best_;
  }

 private:
  static constexpr std::uint32_t chunk = 64;  // edges of A held at a time: 5 kB of stack

  void try_best_faces() {  // the most promising face of each body first: the rest is pruned against it
    const auto most_promising = [](const Side& side) {
      std::uint32_t best = 0;
      double bound = -infinity;
      for (std::uint32_t f = 0; f < side.own.face_normals.size(); ++f) {
        const double b = side.face_bound(f);
        if (b > bound) bound = b, best = f;
      }
      return best;
    };
    try_face_a(most_promising(side_a_));
    try_face_b(most_promising(side_b_));
  }

  void try_face_a(std::uint32_t f) {
    const Vec3& n = pair_.a.face_normals[f];
    const double gap = n.dot(pair_.vertex_b(pair_.support_b(n))) - pair_.a.face_offsets[f];
    if (gap > best_.gap) best_ = {SeparatingAxis::Kind::face_a, gap, n, f, 0};
  }
  void try_face_b(std::uint32_t f) {
    const Vec3& m = pair_.b.face_normals[f];
    const Vec3 n = -(pair_.rotation * m);
    const Vec3 deepest = pair_.rotation.transpose() * (pair_.a.vertices[pair_.support_a(n)] - pair_.offset);
    const double gap = m.dot(deepest) - pair_.b.face_offsets[f];
    if (gap > best_.gap) best_ = {SeparatingAxis::Kind::face_b, gap, n, 0, f};
  }

  void try_edges() {
    std::array<ArcEdge, chunk> held;
    const auto edges = static_cast<std::uint32_t>(pair_.a.edges.size());
    for (std::uint32_t k = 0; k < edges;) {
      std::uint32_t count = 0;
      for (; k < edges && count < chunk; ++k) {
        const HullEdge& edge = pair_.a.edges[k];
        if (!side_a_.edge_may_exceed(edge, best_.gap)) continue;
        held[count++] = {pair_.a.vertices[edge.to] - pair_.a.vertices[edge.from], pair_.a.face_normals[edge.left],
                         pair_.a.face_normals[edge.right], k};
      }
      if (count > 0) try_against({held.data(), count});
    }
  }
  void try_against(std::span<const ArcEdge> held) {
    for (std::uint32_t k = 0; k < pair_.b.edges.size(); ++k) {
      const HullEdge& edge = pair_.b.edges[k];
      if (!side_b_.edge_may_exceed(edge, best_.gap)) continue;
      const ArcEdge other{pair_.rotation * (pair_.b.vertices[edge.to] - pair_.b.vertices[edge.from]),
                          -(pair_.rotation * pair_.b.face_normals[edge.left]), -(pair_.rotation * pair_.b.face_normals[edge.right]), k};
      for (const ArcEdge& own : held) {
        if (arcs_cross(own, other)) try_edge_pair(own, other);
      }
    }
  }
  /// Two arcs cross on the Gauss sphere: the edge pair spans a facet of the Minkowski difference.
  static bool arcs_cross(const ArcEdge& a, const ArcEdge& b) {
    const double left_b = a.direction.dot(b.left), right_b = a.direction.dot(b.right);
    if (left_b * right_b >= 0.0) return false;
    const double left_a = b.direction.dot(a.left), right_a = b.direction.dot(a.right);
    return left_a * right_a < 0.0 && left_b * right_a > 0.0;
  }
  void try_edge_pair(const ArcEdge& own, const ArcEdge& other) {
    Vec3 n = own.direction.cross(other.direction);
    const double square = n.squaredNorm();
    if (!(square > 1e-30 * own.direction.squaredNorm() * other.direction.squaredNorm())) return;  // parallel: faces cover it
    n /= n.dot(own.left + own.right) < 0.0 ? -std::sqrt(square) : std::sqrt(square);
    const Vec3 from_a = pair_.vertex_b(pair_.b.edges[other.index].from) - pair_.a.vertices[pair_.a.edges[own.index].from];
    if (!(n.dot(from_a) > best_.gap)) return;
    // Where arcs only just cross, rounding may have chosen edges that do not support: the bodies themselves decide.
    const double gap = std::min(n.dot(from_a), pair_.separation(n));
    if (gap > best_.gap) best_ = {SeparatingAxis::Kind::edges, gap, n, own.index, other.index};
  }

  const PolyhedronPair& pair_;
  Side side_a_, side_b_;
  double limit_;
  SeparatingAxis best_;
};

/// Closest points of the lines through two edges, kept on the edges.
void edge_witnesses(const PolyhedronPair& pair, PolyhedronDistance& d) {
  const HullEdge &ea = pair.a.edges[d.axis.feature_a], &eb = pair.b.edges[d.axis.feature_b];
  const Vec3 p = pair.a.vertices[ea.from], u = pair.a.vertices[ea.to] - p;
  const Vec3 q = pair.vertex_b(eb.from), v = pair.vertex_b(eb.to) - q;
  const Vec3 across = v.cross(d.axis.normal);  // orthogonal to v: removes the freedom along B's edge
  const double slope = u.dot(across);
  const double t = slope != 0.0 ? std::clamp((q - p).dot(across) / slope, 0.0, 1.0) : 0.5;
  d.witness_a = p + t * u;
  d.witness_b = d.witness_a + d.axis.gap * d.axis.normal;
}

void axis_witnesses(const PolyhedronPair& pair, PolyhedronDistance& d) {
  switch (d.axis.kind) {
    case SeparatingAxis::Kind::edges: return edge_witnesses(pair, d);
    case SeparatingAxis::Kind::face_b:
      d.witness_a = pair.a.vertices[pair.support_a(d.axis.normal)];
      d.witness_b = d.witness_a + d.axis.gap * d.axis.normal;
      return;
    default:
      d.witness_b = pair.vertex_b(pair.support_b(d.axis.normal));
      d.witness_a = d.witness_b - d.axis.gap * d.axis.normal;
  }
}

}  // namespace

PolyhedronPair::PolyhedronPair(const PolyhedronView& view_a, const PolyhedronView& view_b, const Pose& pose_a, const Pose& pose_b)
    : a(view_a), b(view_b) {
  const Mat3 to_a = pose_a.orientation.toRotationMatrix().transpose();
  rotation = to_a * pose_b.orientation.toRotationMatrix();
  offset = to_a * (pose_b.position - pose_a.position);
}

SeparatingAxis separating_axis(const PolyhedronPair& pair, double limit, const SeparatingAxis& start) {
  return AxisSearch(pair, limit, start).run();
}

PolyhedronDistance polyhedron_distance(const PolyhedronPair& pair, double limit, const Vec3& guess) {
  const auto support = [](const void* p, const Vec3& d) {
    const auto& view = *static_cast<const PolyhedronView*>(p);
    return view.vertices[ConvexHull::support_vertex(view, d)];
  };
  const MinkowskiDifference difference({&pair.a, support, pair.a.radius}, {&pair.b, support, pair.b.radius}, pair.rotation, pair.offset);
  const double size = pair.size();
  const GjkResult g = gjk(difference, {limit + 1e-12 * size, 1e-15, guess});
  PolyhedronDistance d;
  d.axis = {SeparatingAxis::Kind::points, g.lower, g.normal, 0, 0};
  d.uncertainty = g.upper - g.lower;
  d.beyond = g.status == GjkResult::Status::beyond;
  if (d.beyond) return d;
  d.witness_a = g.witness_a, d.witness_b = g.witness_b;
  if (g.status == GjkResult::Status::separated) return d;
  const bool apart = g.status == GjkResult::Status::capped;
  const SeparatingAxis found = separating_axis(pair, infinity, apart ? d.axis : SeparatingAxis{});
  if (found.kind == SeparatingAxis::Kind::points) return d;  // nothing better than what GJK certified
  d.axis = found;
  d.uncertainty = apart ? std::max(0.0, g.upper - found.gap) : 0.0;
  axis_witnesses(pair, d);
  d.beyond = found.gap > limit;
  return d;
}

}  // namespace epafi
