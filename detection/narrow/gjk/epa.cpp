#include "detection/narrow/gjk/epa.h"

#include <array>
#include <cmath>

#include "detection/narrow/gjk/gjk.h"

namespace epafi {
namespace {

struct Facet {
  std::array<std::uint16_t, 3> vertex;
  std::array<std::uint16_t, 3> beyond{};  ///< facet across the edge from vertex k to vertex k + 1
  Vec3 normal = Vec3::Zero();             ///< unit, outward
  double distance = infinity;             ///< of its plane from the origin, signed [m]; infinite: the place is free
};

class Polytope {
 public:
  explicit Polytope(const MinkowskiDifference& difference) : difference_(difference) {}

  /// Tetrahedron from extreme points along three axes; false when the difference is flat, with the direction across it
  /// in `normal`.
  bool start(const Mat3& axes, Vec3& normal) {
    count_ = horizon_count_ = free_count_ = 0;
    facets_count_ = 0;
    const double flat = 1e-13 * difference_.size();
    Vec3 e = Vec3::Zero();  // the longest of three spans along the axes
    for (int k = 0; k < 3; ++k) {
      const Vec3 d = axes.col(k);
      const MinkowskiVertex high = difference_.support(d), low = difference_.support(-d);
      if (!((low.y - high.y).squaredNorm() > e.squaredNorm())) continue;
      points_[0] = high;
      points_[1] = low;
      e = low.y - high.y;
    }
    if (!(e.norm() > flat)) {
      normal = Vec3::UnitZ();
      return false;
    }
    e.normalize();
    const Vec3 side = any_orthogonal(e);
    if (!add_across(2, side, e, flat) && !add_across(2, e.cross(side), e, flat)) {
      normal = side;
      return false;
    }
    normal = (points_[1].y - points_[0].y).cross(points_[2].y - points_[0].y).normalized();
    if (!add_across(3, normal, Vec3::Zero(), flat)) return false;
    count_ = 4;
    const bool positive = normal.dot(points_[3].y - points_[0].y) > 0.0;
    if (positive) std::swap(points_[1], points_[2]);  // so that 0 1 2 looks away from 3
    if (!set_facet(0, 0, 1, 2) || !set_facet(1, 0, 3, 1) || !set_facet(2, 1, 3, 2) || !set_facet(3, 2, 3, 0))
      return false;
    facets_[0].beyond = {1, 2, 3};
    facets_[1].beyond = {3, 2, 0};
    facets_[2].beyond = {1, 3, 0};
    facets_[3].beyond = {2, 1, 0};
    facets_count_ = 4;
    return true;
  }

  std::uint16_t nearest() const {
    std::uint16_t best = 0;
    for (std::uint16_t f = 1; f < facets_count_; ++f) {
      if (facets_[f].distance < facets_[best].distance) best = f;
    }
    return best;
  }
  const Facet& facet(std::uint16_t f) const { return facets_[f]; }
  bool is_full() const { return count_ >= epa_vertex_cap; }

  /// Replaces what w sees, a connected cap grown from facet f, by the cone from its horizon. False when w adds nothing
  /// or a facet has no area. (Testing every facet by itself let rounding choose caps with holes: 2 % of smooth pairs.)
  bool expand(std::uint16_t f, const MinkowskiVertex& w) {
    points_[count_] = w;
    const auto apex = static_cast<std::uint16_t>(count_++);
    const double slack = 1e-16 * difference_.size();
    if (!(facets_[f].normal.dot(w.y) - facets_[f].distance > slack)) return false;
    horizon_count_ = free_count_ = 0;
    release(f);
    const Facet seed = facets_[f];
    for (std::size_t k = 0; k < 3; ++k) grow(seed.beyond[k], f, seed.vertex[k], seed.vertex[(k + 1) % 3], w, slack);
    return horizon_count_ >= 3 && close(apex);
  }

  /// Deepest points: the origin's projection on the facet in barycentric coordinates. False where it falls beside the
  /// facet (of several coplanar facets this is another) or the facet is too narrow to tell.
  bool witnesses(const Facet& facet, Vec3& a, Vec3& b) const {
    const auto &p = points_[facet.vertex[0]], &q = points_[facet.vertex[1]], &r = points_[facet.vertex[2]];
    const Vec3 x = facet.distance * facet.normal;
    const Vec3 n = (q.y - p.y).cross(r.y - p.y);
    const double square = n.squaredNorm();
    const double wp = n.dot((q.y - x).cross(r.y - x)) / square, wq = n.dot((r.y - x).cross(p.y - x)) / square;
    const double wr = 1.0 - wp - wq;
    a = wp * p.a + wq * q.a + wr * r.a;
    b = wp * p.b + wq * q.b + wr * r.b;
    constexpr double beside = -1e-12;  // rounding of a weight on a facet of sound shape
    return wp >= beside && wq >= beside && wr >= beside;
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
      if (away > farthest) {
        farthest = away;
        points_[k] = w;
        found = true;
      }
    }
    return found;
  }
  bool set_facet(std::uint16_t f, std::uint16_t i, std::uint16_t j, std::uint16_t k) {
    const Vec3 n = (points_[j].y - points_[i].y).cross(points_[k].y - points_[i].y);
    const double length = n.norm();
    if (!(length > 0.0)) return false;
    facets_[f].vertex = {i, j, k};
    facets_[f].normal = n / length;
    facets_[f].distance = facets_[f].normal.dot(points_[i].y);
    return true;
  }
  void release(std::uint16_t f) {
    facets_[f].distance = infinity;
    free_[free_count_++] = f;
  }
  /// Comes into facet f across the edge i -> j of facet `from`. Visits edges in turn, so that the horizon is a closed
  /// loop.
  void grow(std::uint16_t f, std::uint16_t from, std::uint16_t i, std::uint16_t j, const MinkowskiVertex& w,
            double slack) {
    Facet& facet = facets_[f];
    if (facet.distance == infinity) return;  // already taken into the cap
    if (!(facet.normal.dot(w.y) - facet.distance > slack)) {
      horizon_[horizon_count_++] = {i, j, f};
      return;
    }
    release(f);
    std::size_t entry = 0;
    while (facet.beyond[entry] != from || facet.vertex[(entry + 1) % 3] != i) ++entry;
    for (std::size_t k = 1; k < 3; ++k) {
      const std::size_t side = (entry + k) % 3;
      grow(facet.beyond[side], f, facet.vertex[side], facet.vertex[(side + 1) % 3], w, slack);
    }
  }
  /// Facets from the horizon's edges to the apex, each knowing its neighbours.
  bool close(std::uint16_t apex) {
    std::array<std::uint16_t, horizon_cap>& made = made_;
    for (std::size_t k = 0; k < horizon_count_; ++k) {
      if (free_count_ > 0)
        made[k] = free_[--free_count_];
      else if (facets_count_ < facets_.size())
        made[k] = facets_count_++;
      else
        return false;
    }
    for (std::size_t k = 0; k < horizon_count_; ++k) {
      const Edge& e = horizon_[k];
      if (e.to != horizon_[(k + 1) % horizon_count_].from || !set_facet(made[k], e.from, e.to, apex)) return false;
      facets_[made[k]].beyond = {e.outside, made[(k + 1) % horizon_count_],
                                 made[(k + horizon_count_ - 1) % horizon_count_]};
      for (std::size_t side = 0; side < 3; ++side) {  // the facet outside sees the edge the other way round
        Facet& outside = facets_[e.outside];
        if (outside.vertex[side] == e.to && outside.vertex[(side + 1) % 3] == e.from) outside.beyond[side] = made[k];
      }
    }
    return true;
  }

  struct Edge {
    std::uint16_t from, to, outside;  ///< two vertices and the facet beyond them that stays
  };
  static constexpr std::size_t facet_cap =
      2 * epa_vertex_cap;  // a triangulated sphere of V vertices has 2 V - 4 facets
  static constexpr std::size_t horizon_cap = 3 * facet_cap;

  const MinkowskiDifference& difference_;
  std::array<MinkowskiVertex, epa_vertex_cap> points_;
  std::array<Facet, facet_cap> facets_;
  std::array<Edge, horizon_cap> horizon_;
  std::array<std::uint16_t, horizon_cap> made_;
  std::array<std::uint16_t, facet_cap> free_;
  std::size_t count_ = 0, horizon_count_ = 0, free_count_ = 0;
  std::uint16_t facets_count_ = 0;
};

/// Deepest points by the distance of the bodies once B is pushed out along the normal and a little further: the point
/// of the difference nearest to (depth + a little) n is depth n, whichever of several coplanar facets holds it. (At
/// exact touch of a tip and a face, weights on the wrong facet put the point 0.3 of the size beside the tip.) Where
/// they overlap still, as the depth of a sliver is known to rounding only, the points farthest along the normal.
void push_apart(const MinkowskiDifference& difference, Penetration& p) {
  const MinkowskiVertex tips = difference.support(p.normal);
  p.witness_a = tips.a;
  p.witness_b = tips.b;
  const Vec3 push = (p.upper + 1e-3 * difference.size()) * p.normal;
  MinkowskiDifference apart = difference;
  apart.offset += push;
  const GjkResult g = gjk(apart, {infinity, 1e-15, p.normal});
  if (g.status == GjkResult::Status::overlapping) return;
  p.witness_a = g.witness_a;
  p.witness_b = g.witness_b - push;
}

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
  push_apart(difference, out);
  return out;
}

/// One polytope grown until the interval closes, or as far as it goes. True: another start may do better.
bool grow(const MinkowskiDifference& difference, double tolerance, const Mat3& axes, Polytope& polytope,
          Penetration& out) {
  Vec3 across;
  const double allowed = tolerance * difference.size();
  if (!polytope.start(axes, across)) {
    out = across_flat(difference, across);
    return false;
  }
  bool on_facet = false;
  out.upper = infinity;
  for (out.iterations = 1; !polytope.is_full(); ++out.iterations) {
    const std::uint16_t f = polytope.nearest();
    const Facet facet = polytope.facet(f);
    out.lower = facet.distance;
    const MinkowskiVertex w = difference.support(facet.normal);
    const double height = facet.normal.dot(w.y);
    if (height < out.upper) {
      out.upper = height;
      out.normal = facet.normal;
    }
    const bool closed = out.upper - out.lower <= allowed;
    if (closed) {
      out.status = Penetration::Status::converged;
      // of several equally near facets the one that closes the interval may be another than the one that gave `upper`
      on_facet = height - facet.distance <= allowed && polytope.witnesses(facet, out.witness_a, out.witness_b);
      if (on_facet) {
        out.upper = height;
        out.normal = facet.normal;
      }
    }
    if (closed || !polytope.expand(f, w)) break;
  }
  if (!on_facet) push_apart(difference, out);
  const bool lost = out.lower < -1e-6 * difference.size();  // the origin is outside: no polytope of overlapping bodies
  // A polytope that is full and still far from closed went astray on facets of equal distance (2 identical bodies).
  const bool astray = out.upper - out.lower > 1e-3 * difference.size();
  return out.status == Penetration::Status::degenerate && (lost || astray || !polytope.is_full());
}

}  // namespace

Penetration epa(const MinkowskiDifference& difference, double tolerance) {
  Polytope polytope(difference);
  Penetration best;
  // Two equal bodies in one pose have a difference full of coplanar facets and collinear edges, on which 7 of 60
  // polytopes get stuck. All intervals hold the depth, so they are cut with each other; a turned start gets stuck
  // elsewhere.
  Mat3 axes = Mat3::Identity();
  double lower = -infinity;
  constexpr int starts = 6;
  for (int k = 0; k < starts; ++k) {
    Penetration p;
    const bool stuck = grow(difference, tolerance, axes, polytope, p);
    lower = std::max(lower, p.lower);
    if (k == 0 || p.upper < best.upper || !stuck) best = p;
    if (!stuck) break;
    if (best.upper - lower <= tolerance * difference.size()) {
      best.lower = lower;
      best.status = Penetration::Status::converged;
      break;
    }
    axes = axes * Eigen::AngleAxisd(1.0, Vec3(0.36, 0.48, 0.8)).toRotationMatrix();
  }
  best.lower = std::min(std::max(best.lower, lower), best.upper);
  return best;
}

}  // namespace epafi
