/// @file gjk_loop.h  The loop of GJK over any difference that offers support(d) and size(): compiled once behind
/// function pointers for all shapes (gjk.cpp) and once with the supports of polyhedra inside (polyhedra.cpp: 0.7 of the
/// time).
#pragma once
#include <cmath>
#include <type_traits>

#include "detection/narrow/gjk/gjk.h"
#include "engine/state/frame.h"

namespace epafi::gjk_detail {

/// Candidate: which vertices, their weights, the point, its squared distance.
struct Closest {
  std::array<int, 3> index{};
  std::array<double, 3> weight{};
  int count = 0;
  Vec3 point = Vec3::Zero();
  double square = infinity;
  void keep_nearer(const Closest& o) {
    if (o.square < square) *this = o;
  }
};

inline Closest on_vertex(const Simplex& s, int i) {
  const Vec3& y = s.vertex[static_cast<std::size_t>(i)].y;
  return {{i, 0, 0}, {1.0, 0.0, 0.0}, 1, y, y.squaredNorm()};
}

inline Closest on_segment(const Simplex& s, int i, int j) {
  const Vec3 &p = s.vertex[static_cast<std::size_t>(i)].y, &q = s.vertex[static_cast<std::size_t>(j)].y;
  const Vec3 e = q - p;
  const double along_p = -p.dot(e), along_q = q.dot(e);  // both > 0 inside; each computed from its own end
  if (!(along_p > 0.0)) return on_vertex(s, i);
  if (!(along_q > 0.0)) return on_vertex(s, j);
  const double t = along_p / (along_p + along_q);
  // From the nearer end: the product t e is then the smaller correction.
  const Vec3 v = t < 0.5 ? Vec3(p + t * e) : Vec3(q - (1.0 - t) * e);
  return {{i, j, 0}, {1.0 - t, t, 0.0}, 2, v, v.squaredNorm()};
}

inline Closest on_triangle(const Simplex& s, int i, int j, int k) {
  const Vec3 &a = s.vertex[static_cast<std::size_t>(i)].y, &b = s.vertex[static_cast<std::size_t>(j)].y,
             &c = s.vertex[static_cast<std::size_t>(k)].y;
  const Vec3 n = (b - a).cross(c - a);
  const double square = n.squaredNorm();
  const double wa = n.dot(b.cross(c)), wb = n.dot(c.cross(a)), wc = n.dot(a.cross(b));  // signed areas, sum n^2
  if (square > 0.0 && wa > 0.0 && wb > 0.0 && wc > 0.0) {
    const Vec3 v = n * (n.dot(a) / square);
    const double sum = wa + wb + wc;
    return {{i, j, k}, {wa / sum, wb / sum, wc / sum}, 3, v, v.squaredNorm()};
  }
  Closest
      best;  // the origin projects outside across an edge whose area is not positive; all edges where areas are noise
  const bool noise = !(square > 0.0);
  if (noise || !(wa > 0.0)) best.keep_nearer(on_segment(s, j, k));
  if (noise || !(wb > 0.0)) best.keep_nearer(on_segment(s, i, k));
  if (noise || !(wc > 0.0)) best.keep_nearer(on_segment(s, i, j));
  return best;
}

/// All faces of a tetrahedron on whose outer side the origin is; `inside` where it is on none of them.
inline Closest on_tetrahedron(const Simplex& s, bool& inside) {
  const Vec3 &a = s.vertex[0].y, &b = s.vertex[1].y, &c = s.vertex[2].y, &d = s.vertex[3].y;
  const double va = b.dot(c.cross(d)), vb = -a.dot(c.cross(d)), vc = a.dot(b.cross(d)), vd = -a.dot(b.cross(c));
  const double volume = (b - a).dot((c - a).cross(d - a));
  const double sign = volume < 0.0 ? -1.0 : 1.0;
  // Below this the tetrahedron is flat to rounding and its signs are noise: every face is tested.
  const double scale = std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm(), d.squaredNorm()});
  const bool flat = !(std::abs(volume) > 1e-15 * scale * std::sqrt(scale));
  inside = !flat && sign * va > 0.0 && sign * vb > 0.0 && sign * vc > 0.0 && sign * vd > 0.0;
  Closest best;
  if (inside) return best;
  if (flat || !(sign * va > 0.0)) best.keep_nearer(on_triangle(s, 1, 2, 3));
  if (flat || !(sign * vb > 0.0)) best.keep_nearer(on_triangle(s, 0, 2, 3));
  if (flat || !(sign * vc > 0.0)) best.keep_nearer(on_triangle(s, 0, 1, 3));
  if (flat || !(sign * vd > 0.0)) best.keep_nearer(on_triangle(s, 0, 1, 2));
  return best;
}

inline void find_witnesses(GjkResult& r) {
  r.witness_a.setZero();
  r.witness_b.setZero();
  for (int k = 0; k < r.simplex.count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    r.witness_a += r.simplex.weight[i] * r.simplex.vertex[i].a;
    r.witness_b += r.simplex.weight[i] * r.simplex.vertex[i].b;
  }
}

/// Closed polyhedral searches leave rounding in v, which a tiny distance turns into a wrong direction. The simplex
/// gives the direction without that loss: normal to its plane, or v made orthogonal to its segment.
template <class Difference>
void polish_normal(const Difference& difference, const Vec3& v, GjkResult& r) {
  const auto& y = r.simplex.vertex;
  Vec3 n = -v;
  if (r.simplex.count == 3) {
    n = (y[1].y - y[0].y).cross(y[2].y - y[0].y);
    if (n.dot(v) > 0.0) n = -n;
  } else if (r.simplex.count == 2) {
    const Vec3 e = (y[1].y - y[0].y).normalized();
    n = y[0].y.squaredNorm() < y[1].y.squaredNorm() ? -y[0].y : -y[1].y;
    for (int pass = 0; pass < 3; ++pass)
      n = (n - e * e.dot(n)).normalized();  // twice is enough, unless n was all along e
  }
  if (!(n.squaredNorm() > 0.0)) return;
  const auto take = [&](const Vec3& d) -> Vec3 {
    const MinkowskiVertex w = difference.support(d);
    const double bound = -d.dot(w.y);
    if (bound > r.lower) {
      r.lower = bound;
      r.normal = d;
    }
    return w.y;
  };
  const Vec3 third = take(n = n.normalized());
  // A face of which the simplex holds two vertices: rounding over the distance leaves the direction open by more than
  // 1e-11 where they are 1e-5 apart. The vertex that stands out along it is a third of the face.
  if (r.simplex.count != 2 || !(r.upper - r.lower > 1e-12 * difference.size())) return;
  Vec3 plane = (y[1].y - y[0].y).cross(third - y[0].y);
  if (plane.dot(n) < 0.0) plane = -plane;
  if (plane.squaredNorm() > 0.0) take(plane.normalized());
}

inline Vec3 weighted_point(const Simplex& s) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < static_cast<std::size_t>(s.count); ++k) sum += s.weight[k] * s.vertex[k].y;
  return sum;
}

inline bool holds(const Simplex& s, const MinkowskiVertex& w) {
  for (int k = 0; k < s.count; ++k) {
    const auto& v = s.vertex[static_cast<std::size_t>(k)];
    if (v.a == w.a && v.b == w.b) return true;
  }
  return false;
}

inline Vec3 reduce_to_closest(Simplex& s, bool& contains_origin) {
  contains_origin = false;
  Closest best = on_vertex(s, 0);
  switch (s.count) {
    case 1:
      break;
    case 2:
      best = on_segment(s, 0, 1);
      break;
    case 3:
      best = on_triangle(s, 0, 1, 2);
      break;
    default:
      best = on_tetrahedron(s, contains_origin);
  }
  if (contains_origin) return Vec3::Zero();
  for (int k = 0; k < best.count; ++k) {  // indices ascend: a vertex never moves onto one still needed
    const auto to = static_cast<std::size_t>(k), from = static_cast<std::size_t>(best.index[to]);
    if (from != to) s.vertex[to] = s.vertex[from];
    s.weight[to] = best.weight[to];
  }
  s.count = best.count;
  return best.point;
}

/// Smooth bodies: the direction n whose support point lies along it, by Newton steps with differences for the
/// derivative. GJK alone gains only a factor of about 0.6 per support near the end there (64 were not enough for 1 of
/// 1e5 pairs of ellipsoids). True where the interval closes; where the bodies are not smooth enough it does not, and
/// GJK goes on.
template <class Difference>
bool close_by_newton(const Difference& difference, double allowed, GjkResult& r) {
  constexpr double step = 1e-5;  // rad: the derivative is right to about this, so each Newton step gains that factor
  constexpr int steps = 4;
  Vec3 n = r.normal;
  double before = infinity;
  for (int k = 0; k < steps; ++k) {
    const MinkowskiVertex y = difference.support(n);
    const double bound = -n.dot(y.y), length = y.y.norm();
    const Vec3 beside = y.y + bound * n;
    if (!(beside.norm() < 0.5 * before) || !(bound > 0.0)) return false;
    before = beside.norm();
    if (bound > r.lower) {
      r.lower = bound;
      r.normal = n;
    }
    if (length <= r.upper) {
      r.upper = length;
      r.simplex.vertex[0] = y;
      r.simplex.weight[0] = 1.0;
      r.simplex.count = 1;
    }
    if (r.upper - r.lower <= allowed) return r.simplex.count == 1;
    const ContactFrame frame = contact_frame(n);
    const Vec3 &e1 = frame.tangent1, &e2 = frame.tangent2;
    const auto derivative = [&](const Vec3& e) -> Vec3 {
      const Vec3 turned = (n + step * e).normalized();
      const Vec3 x = difference.support(turned).y;
      return (x - turned.dot(x) * turned - beside) / step;
    };
    const Vec3 d1 = derivative(e1), d2 = derivative(e2);
    const double a = d1.dot(e1), b = d2.dot(e1), c = d1.dot(e2), d = d2.dot(e2), determinant = a * d - b * c;
    if (!(determinant > 0.0)) return false;
    const double f = beside.dot(e1), g = beside.dot(e2);
    n = (n - (d * f - b * g) / determinant * e1 - (a * g - c * f) / determinant * e2).normalized();
  }
  return false;
}

inline constexpr int newton_interval = 8;  // iterations between attempts; 6 to 14 take the same time within 4 %

/// True where the search ends so; r is left as it was otherwise.
template <class Difference>
bool end_by_newton(const Difference& difference, const GjkOptions& options, GjkResult& r) {
  if (r.iterations % newton_interval != 0 || !(r.lower > 0.0)) return false;
  GjkResult finer = r;
  if (!close_by_newton(difference, options.tolerance * difference.size(), finer)) return false;
  find_witnesses(finer);
  finer.status = finer.lower > options.limit ? GjkResult::Status::beyond : GjkResult::Status::separated;
  r = finer;
  return true;
}

inline Vec3 first_direction(const Vec3& guess, const Vec3& between_centres) {
  if (guess.squaredNorm() > 0.0) return guess;
  return between_centres.squaredNorm() > 0.0 ? between_centres : Vec3(Vec3::UnitX());
}

template <class Difference>
GjkResult run(const Difference& difference, const GjkOptions& options) {
  using Status = GjkResult::Status;
  GjkResult r;
  const double size = difference.size();
  r.simplex.vertex[0] = difference.support(first_direction(options.guess, difference.offset));
  r.simplex.weight[0] = 1.0;
  r.simplex.count = 1;
  Vec3 v = r.simplex.vertex[0].y;
  r.lower = -infinity;
  r.upper = infinity;
  bool inside = false;
  for (r.iterations = 1; r.iterations <= gjk_cap; ++r.iterations) {
    const double distance = v.norm();
    if (!(distance > 1e-15 * size)) break;  // touching to rounding
    // The point by its weights lies in the difference whatever rounding did to the projection: its length is an upper
    // bound.
    const double length = weighted_point(r.simplex).norm();
    const bool stalled = !(length < r.upper);
    r.upper = std::min(r.upper, length);
    const MinkowskiVertex w = difference.support(-v);
    const double bound = v.dot(w.y) / distance;
    if (bound > r.lower) {
      r.lower = bound;
      r.normal = -v / distance;
    }
    if (r.lower > options.limit) {
      r.status = Status::beyond;
      return r;
    }
    const bool closed = r.upper - r.lower <= options.tolerance * size;
    if (closed || stalled || holds(r.simplex, w)) {
      if (!closed) polish_normal(difference, v, r);
      if (!(r.lower > 0.0)) break;  // closer than rounding can tell
      find_witnesses(r);
      // A repeated vertex ends a polyhedral search exactly; what is left of the interval is rounding, and is reported.
      r.status = r.upper - r.lower <= options.tolerance * size ? Status::separated : Status::capped;
      return r;
    }
    if constexpr (std::is_same_v<Difference, MinkowskiDifference>) {
      if (end_by_newton(difference, options, r)) return r;
    }
    r.simplex.vertex[static_cast<std::size_t>(r.simplex.count++)] = w;
    v = reduce_to_closest(r.simplex, inside);
    if (inside) break;
  }
  find_witnesses(r);
  r.status = r.iterations > gjk_cap && r.lower > 0.0 ? Status::capped : Status::overlapping;
  return r;
}

}  // namespace epafi::gjk_detail
