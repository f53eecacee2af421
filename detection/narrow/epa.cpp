#include "detection/narrow/epa.h"

#include <array>
#include <cmath>

namespace epafi {
namespace {

struct Facet {
  std::array<std::uint16_t, 3> vertex;
  Vec3 normal;      ///< unit, outward
  double distance;  ///< of its plane from the origin, signed [m]
};

class Polytope {
 public:
  explicit Polytope(const MinkowskiDifference& difference) : difference_(difference) {}

  /// Tetrahedron from extreme points; false when the difference is flat, with the direction across it in `normal`.
  bool start(Vec3& normal) {
    const double flat = 1e-13 * difference_.size();
    Vec3 e = Vec3::Zero();  // the longest of three spans along the axes
    for (const Vec3& d : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
      const MinkowskiVertex high = difference_.support(d), low = difference_.support(-d);
      if (!((low.y - high.y).squaredNorm() > e.squaredNorm())) continue;
      points_[0] = high, points_[1] = low, e = low.y - high.y;
    }
    if (!(e.norm() > flat)) return normal = Vec3::UnitZ(), false;
    e.normalize();
    const Vec3 side = any_orthogonal(e);
    if (!add_across(2, side, e, flat) && !add_across(2, e.cross(side), e, flat)) return normal = side, false;
    normal = (points_[1].y - points_[0].y).cross(points_[2].y - points_[0].y).normalized();
    if (!add_across(3, normal, Vec3::Zero(), flat)) return false;
    count_ = 4;
    const bool positive = normal.dot(points_[3].y - points_[0].y) > 0.0;
    if (positive) std::swap(points_[1], points_[2]);  // so that 0 1 2 looks away from 3
    return add_facet(0, 1, 2) && add_facet(0, 3, 1) && add_facet(1, 3, 2) && add_facet(2, 3, 0);
  }

  const Facet& nearest() const {
    std::size_t best = 0;
    for (std::size_t f = 1; f < facets_count_; ++f) {
      if (facets_[f].distance < facets_[best].distance) best = f;
    }
    return facets_[best];
  }
  bool is_full() const { return count_ >= epa_vertex_cap; }

  /// Replaces the facets that w sees by the cone from its horizon; false when w adds nothing or a facet has no area.
  bool expand(const MinkowskiVertex& w) {
    std::size_t edges = 0, kept = 0;
    for (std::size_t f = 0; f < facets_count_; ++f) {
      const Facet& facet = facets_[f];
      if (!(facet.normal.dot(w.y) - facet.distance > 0.0)) {
        facets_[kept++] = facet;
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) toggle(facet.vertex[k], facet.vertex[(k + 1) % 3], edges);
    }
    facets_count_ = kept;
    if (edges < 3) return false;
    points_[count_] = w;
    const auto apex = static_cast<std::uint16_t>(count_++);
    for (std::size_t k = 0; k < edges; ++k) {
      if (!add_facet(horizon_[k].first, horizon_[k].second, apex)) return false;
    }
    return true;
  }

  /// Deepest points: the origin's projection on the facet in barycentric coordinates.
  void witnesses(const Facet& facet, Vec3& a, Vec3& b) const {
    const auto &p = points_[facet.vertex[0]], &q = points_[facet.vertex[1]], &r = points_[facet.vertex[2]];
    const Vec3 x = facet.distance * facet.normal;
    const Vec3 n = (q.y - p.y).cross(r.y - p.y);
    const double square = n.squaredNorm();
    const double wp = n.dot((q.y - x).cross(r.y - x)) / square, wq = n.dot((r.y - x).cross(p.y - x)) / square;
    a = wp * p.a + wq * q.a + (1.0 - wp - wq) * r.a;
    b = wp * p.b + wq * q.b + (1.0 - wp - wq) * r.b;
  }

 private:
  static Vec3 any_orthogonal(const Vec3& e) {
    const Vec3 axis = std::abs(e.x()) < std::abs(e.y()) && std::abs(e.x()) < std::abs(e.z()) ? Vec3::UnitX()
                      : std::abs(e.y()) < std::abs(e.z())                                    ? Vec3::UnitY()
                                                                                              : Vec3::UnitZ();
    return e.cross(axis).normalized();
  }
  /// Extreme point along +d or -d, whichever lies farther from the span so far (line along e, or plane when e is 0).
  bool add_across(std::size_t k, const Vec3& d, const Vec3& e, double flat) {
    double farthest = flat;
    bool found = false;
    for (const double sign : {1.0, -1.0}) {
      const MinkowskiVertex w = difference_.support(sign * d);
      const Vec3 v = w.y - points_[0].y;
      const double away = e.squaredNorm() > 0.0 ? (v - e * e.dot(v)).norm() : std::abs(d.dot(v));
      if (away > farthest) farthest = away, points_[k] = w, found = true;
    }
    return found;
  }
  bool add_facet(std::uint16_t i, std::uint16_t j, std::uint16_t k) {
    if (facets_count_ == facets_.size()) return false;
    const Vec3 n = (points_[j].y - points_[i].y).cross(points_[k].y - points_[i].y);
    const double length = n.norm();
    if (!(length > 0.0)) return false;
    const Vec3 unit = n / length;
    facets_[facets_count_++] = {{i, j, k}, unit, unit.dot(points_[i].y)};
    return true;
  }
  /// An edge seen from both its facets is inside the hole; seen from one it is on the horizon.
  void toggle(std::uint16_t i, std::uint16_t j, std::size_t& edges) {
    for (std::size_t k = 0; k < edges; ++k) {
      if (horizon_[k].first == j && horizon_[k].second == i) {
        horizon_[k] = horizon_[--edges];
        return;
      }
    }
    horizon_[edges++] = {i, j};
  }

  const MinkowskiDifference& difference_;
  std::array<MinkowskiVertex, epa_vertex_cap> points_;
  std::array<Facet, 2 * epa_vertex_cap> facets_;  // a triangulated sphere of V vertices has 2 V - 4 facets
  std::array<std::pair<std::uint16_t, std::uint16_t>, 6 * epa_vertex_cap> horizon_;
  std::size_t count_ = 0, facets_count_ = 0;
};

/// A difference without volume holds the origin in its plane: it is left across the plane at once.
Penetration across_flat(const MinkowskiDifference& difference, const Vec3& normal) {
  Penetration out;
  const MinkowskiVertex above = difference.support(normal), below = difference.support(-normal);
  const double up = normal.dot(above.y), down = -normal.dot(below.y);
  out.status = Penetration::Status::flat;
  out.normal = up <= down ? normal : Vec3(-normal);
  out.upper = std::min(up, down);
  out.lower = std::min(0.0, out.upper);
  out.witness_a = up <= down ? above.a : below.a;
  out.witness_b = out.witness_a - out.upper * out.normal;
  return out;
}

}  // namespace

Penetration epa(const MinkowskiDifference& difference, double tolerance) {
  Polytope polytope(difference);
  Penetration out;
  Vec3 across;
  if (!polytope.start(across)) return across_flat(difference, across);
  out.upper = infinity;
  for (out.iterations = 1; !polytope.is_full(); ++out.iterations) {
    const Facet facet = polytope.nearest();
    out.lower = facet.distance;
    const MinkowskiVertex w = difference.support(facet.normal);
    const double height = facet.normal.dot(w.y);
    if (height < out.upper) {
      out.upper = height, out.normal = facet.normal;
      polytope.witnesses(facet, out.witness_a, out.witness_b);
    }
    const bool closed = out.upper - out.lower <= tolerance * difference.size();
    if (closed) out.status = Penetration::Status::converged;
    if (closed || !polytope.expand(w)) break;
  }
  return out;
}

}  // namespace epafi
