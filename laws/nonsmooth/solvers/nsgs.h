/// @file nsgs.h  The exact solution of one contact with Coulomb friction (Bonnefon and Daviet 2011, here by a bracketed
/// root). With the other contacts frozen, u = W r + q. Take-off: q_N >= 0, r = 0. Stick: u = 0, r = -W^-1 q inside the
/// cone. Slip: u_N = 0 and u_T = -lambda r_T, lambda > 0, so that with S = W_TT - W_TN W_NT / W_NN
///   (S + lambda 1) r_T = W_TN q_N / W_NN - q_T,   r_N = -(q_N + W_NT r_T) / W_NN,
/// and lambda is a root of |r_T| - mu r_N, positive at 0 (outside the cone) and negative for lambda to infinity.
#pragma once
#include <cmath>
#include <limits>

#include "engine/lanes/lanes.h"
#include "laws/nonsmooth/cone.h"
#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

struct NsgsRule {
  struct Data {
    double nn, tn1, tn2, s11, s22, s12;  ///< W_NN, W_TN and S [1/kg]
  };
  static Data pack(const Mat3& w) {
    if (w(0, 0) <= 0.0) return {0, 0, 0, 0, 0, 0};
    const double nn = w(0, 0), x = w(1, 0), y = w(2, 0);
    return {nn, x, y, w(1, 1) - x * x / nn, w(2, 2) - y * y / nn, w(1, 2) - x * y / nn};
  }

  /// Local solution for q [m/s].
  static Vec3 solve(const Data& d, double mu, const Vec3& q) {
    if (q.x() >= 0.0 || d.nn <= 0.0) return Vec3::Zero();
    const double b1 = d.tn1 * q.x() / d.nn - q.y(), b2 = d.tn2 * q.x() / d.nn - q.z();
    if (mu <= 0.0) return {-q.x() / d.nn, 0.0, 0.0};
    const auto at = [&](double lambda) {
      const double p = d.s11 + lambda, s = d.s22 + lambda, inverse = 1.0 / (p * s - d.s12 * d.s12);
      return Point{lambda, p, s, inverse, (s * b1 - d.s12 * b2) * inverse, (p * b2 - d.s12 * b1) * inverse};
    };
    const auto normal = [&](const Point& x) { return -(q.x() + d.tn1 * x.t1 + d.tn2 * x.t2) / d.nn; };
    const Point sticking = at(0.0);
    if (sticking.length() <= mu * normal(sticking)) return {normal(sticking), sticking.t1, sticking.t2};
    const Point end = slip(d, mu, sticking, at, normal);
    return project_disk({normal(end), end.t1, end.t2}, mu * std::max(0.0, normal(end)));
  }
  Vec3 update(const Data& d, double mu, const Vec3& r, const Vec3& u) const {
    // q = u - W r with W_TT = S + W_TN W_NT / W_NN
    if (d.nn <= 0.0) return Vec3::Zero();
    const double n = d.nn * r.x() + d.tn1 * r.y() + d.tn2 * r.z();
    return solve(d, mu,
                 u - Vec3(n, d.tn1 * n / d.nn + d.s11 * r.y() + d.s12 * r.z(),
                          d.tn2 * n / d.nn + d.s12 * r.y() + d.s22 * r.z()));
  }

  // the same for four contacts
  static constexpr int rows = 3;
  struct LaneData {
    Lanes nn, step_n, tn1, tn2, s11, s22, s12;  ///< step_n: 1/W_NN, 0 where nothing moves
  };
  static void pack(const ContactProblem& problem, std::size_t i, LaneData& data, std::size_t lane) {
    const Data d = pack(problem.diagonal[i]);
    data.nn[lane] = d.nn;
    data.step_n[lane] = d.nn > 0.0 ? 1.0 / d.nn : 0.0;
    data.tn1[lane] = d.tn1;
    data.tn2[lane] = d.tn2;
    data.s11[lane] = d.s11;
    data.s22[lane] = d.s22;
    data.s12[lane] = d.s12;
  }
  EPAFI_LANES void update(const LaneData& d, Lanes mu, Lanes (&r)[3], const Lanes (&u)[3]) const {
    const Lanes n = d.nn * r[0] + d.tn1 * r[1] + d.tn2 * r[2], n_over = n * d.step_n;
    const Lanes q = u[0] - n, q_over = q * d.step_n;
    const LaneMask touches = (q < 0.0) & (d.nn > 0.0), rubs = touches & (mu > 0.0);
    Slip slip{d, -q_over, {}, {}};
    slip.b1 = keep<Lanes>(rubs, d.tn1 * q_over - (u[1] - (d.tn1 * n_over + d.s11 * r[1] + d.s12 * r[2])));
    slip.b2 = keep<Lanes>(rubs, d.tn2 * q_over - (u[2] - (d.tn2 * n_over + d.s12 * r[1] + d.s22 * r[2])));
    slip.take(Lanes{});
    const LaneMask slides = rubs & (slip.tangential2() > mu * mu * slip.normal * max(Lanes{}, slip.normal));
    if (any(slides)) slip.search(mu, slides);
    r[0] = keep<Lanes>(touches, max(Lanes{}, slip.normal));
    r[1] = keep<Lanes>(rubs, slip.t1);
    r[2] = keep<Lanes>(rubs, slip.t2);
  }

 private:
  /// The impulses of four contacts at one lambda each, and the search for it by Newton's method on
  /// mu r_N / |r_T| - 1, which without coupling W_TN is nearly linear; halves its bracket where that leads out of it.
  struct Slip {
    const LaneData& d;
    Lanes free_normal, b1, b2;
    Lanes lambda{}, p{}, s{}, inverse{}, t1{}, t2{}, normal{};

    EPAFI_LANES void take(Lanes at) {
      lambda = at;
      p = d.s11 + at;
      s = d.s22 + at;
      inverse = 1.0 / (p * s - d.s12 * d.s12);
      t1 = (s * b1 - d.s12 * b2) * inverse;
      t2 = (p * b2 - d.s12 * b1) * inverse;
      normal = free_normal - (d.tn1 * t1 + d.tn2 * t2) * d.step_n;
    }
    EPAFI_LANES Lanes tangential2() const { return t1 * t1 + t2 * t2; }
    /// Lanes that have ended stay as they are, so that none depends on its neighbours.
    EPAFI_LANES void search(Lanes mu, LaneMask active) {
      constexpr double rounding = 1e-15, unbounded = 1e300;
      const LaneMask slides = active;
      const Lanes scale = max(d.s11 + d.s22, 1e-12 * d.nn);
      Lanes low{}, high = lanes(unbounded);
      for (int k = 0; k < 64; ++k) {
        const Lanes length2 = tangential2(), length = sqrt(length2);
        const Lanes value = mu * normal / length - 1.0;
        const Lanes w1 = (s * t1 - d.s12 * t2) * inverse, w2 = (p * t2 - d.s12 * t1) * inverse;
        const Lanes of_normal = (d.tn1 * w1 + d.tn2 * w2) * d.step_n, of_length = (t1 * w1 + t2 * w2) / length2;
        const Lanes slope = mu * (of_normal + normal * of_length) / length;
        active &= max(value, -value) > rounding;
        low = select(active & (value < 0.0), lambda, low);
        high = select(active & (value > 0.0), lambda, high);
        const Lanes newton = lambda - value / slope;
        const LaneMask leads_on = (slope > 0.0) & (newton > low) & (newton < high);
        const Lanes halved = select(high < unbounded, 0.5 * (low + high), max(4.0 * lambda, scale));
        const Lanes next = select(leads_on, newton, halved);
        active &= max(next - lambda, lambda - next) > rounding * next;
        if (!any(active)) break;
        take(select(active, next, lambda));
      }
      const Lanes radius = mu * max(Lanes{}, normal), length2 = tangential2();
      const LaneMask beyond = slides & (length2 > radius * radius);
      const Lanes share = select(beyond, radius / sqrt(length2), lanes(1.0));
      t1 = share * t1;
      t2 = share * t2;
    }
  };

  /// The impulses of one contact at one lambda.
  struct Point {
    double lambda, p, s, inverse, t1, t2;
    double length() const { return std::sqrt(t1 * t1 + t2 * t2); }
  };
  /// The same search for one contact.
  template <class At, class Normal>
  static Point slip(const Data& d, double mu, Point now, const At& at, const Normal& normal) {
    constexpr double rounding = 1e-15;
    double low = 0.0, high = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 64; ++k) {
      const double length = now.length(), pressed = normal(now), value = mu * pressed / length - 1.0;
      if (std::abs(value) <= rounding) break;
      (value < 0.0 ? low : high) = now.lambda;
      const double w1 = (now.s * now.t1 - d.s12 * now.t2) * now.inverse;
      const double w2 = (now.p * now.t2 - d.s12 * now.t1) * now.inverse;
      const double of_normal = (d.tn1 * w1 + d.tn2 * w2) / d.nn;
      const double of_length = (now.t1 * w1 + now.t2 * w2) / (length * length);
      const double slope = mu * (of_normal + pressed * of_length) / length;
      const double newton = now.lambda - value / slope, scale = std::max(d.s11 + d.s22, 1e-12 * d.nn);
      const bool leads_on = slope > 0.0 && newton > low && newton < high;
      const double halved = std::isfinite(high) ? 0.5 * (low + high) : std::max(4.0 * now.lambda, scale);
      const double next = leads_on ? newton : halved;
      if (std::abs(next - now.lambda) <= rounding * next) break;
      now = at(next);
    }
    return now;
  }
};

}  // namespace epafi
