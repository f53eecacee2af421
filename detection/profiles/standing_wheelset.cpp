/// A wheelset that stands on both rails, and the conicity of its rolling radii.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "detection/profiles/wheel_rail.h"

namespace epafi {

namespace {

constexpr double no_place = std::numeric_limits<double>::quiet_NaN();

/// Both wheels of a wheelset that rolls about its middle until it stands on both rails.
class Standing {
 public:
  Standing(const WheelRailPair& side, const WheelsetPosition& start)
      : left_(side.on_side(false)), right_(side.on_side(true)), radius_(side.track().radius), p_(start) {}

  /// Roll and height with the shift counted at the rails: there the contacts hardly move with the roll, and the gaps
  /// close by its difference times their distance. False where a wheel lies beside its rail.
  bool at_rails(double shift) {
    for (int k = 0; k < 40; ++k) {
      p_.lateral_shift = shift + p_.roll * radius_;
      left_.place(p_);
      right_.place(p_);
      const double gl = left_.clearance(), gr = right_.clearance();
      if (!std::isfinite(gl) || !std::isfinite(gr)) return false;
      p_.height += 0.5 * (gl + gr);
      p_.roll += (gr - gl) / (2.0 * right_.rail_axis());
      if (std::abs(p_.roll) > 1.0) return false;
      if (std::abs(gl) + std::abs(gr) < 1e-12) break;
    }
    p_.lateral_shift = shift + p_.roll * radius_;
    return true;
  }

  /// Axle's middle at this shift: the place at the rails that it belongs to, the first one outwards.
  bool at_axle(double shift) {
    const auto beside = [&](double at) { return at_rails(at) ? p_.lateral_shift - shift : no_place; };
    double from = shift, f_from = beside(from), step = std::max(1e-6, 1.5 * std::abs(f_from)), to = from, f_to = f_from;
    while (f_to * f_from > 0.0) {
      from = to;
      f_from = f_to;
      to -= std::copysign(step, f_from);
      f_to = beside(to);
      step = std::min(2.0 * step, 1e-3);
      if (std::abs(to - shift) > 0.2) return false;
    }
    for (int k = 0; k < 100 && f_to != 0.0 && std::abs(to - from) > 1e-13; ++k) {
      // regula falsi, halved on the side that stays (Illinois)
      const double middle = to - f_to * (to - from) / (f_to - f_from), f = beside(middle);
      if (std::isnan(f)) return false;
      f_from = f * f_to < 0.0 ? f_to : 0.5 * f_from;
      from = f * f_to < 0.0 ? to : from;
      to = middle;
      f_to = f;
      if (std::abs(f) < 1e-14) break;
    }
    return !std::isnan(f_to);
  }

  WheelsetGeometry found() {
    left_.place(p_);
    right_.place(p_);
    const auto left = left_.deepest(), right = right_.deepest();
    if (!left || !right) return {p_, {}, {}, false};
    return {p_, *left, *right};
  }
  WheelsetGeometry none() const { return {p_, {}, {}, false}; }

 private:
  WheelRailPair left_, right_;
  double radius_;
  WheelsetPosition p_;
};

}  // namespace

WheelsetGeometry stand_on_rails(const WheelRailPair& side, WheelsetPosition p) {
  Standing both(side, p);
  return both.at_axle(p.lateral_shift) ? both.found() : both.none();
}

WheelsetGeometry stand_at_rails(const WheelRailPair& side, WheelsetPosition p) {
  Standing both(side, p);
  return both.at_rails(p.lateral_shift) ? both.found() : both.none();
}

double equivalent_conicity(const Profile& wheel, const Profile& rail, const TrackGeometry& track, double amplitude) {
  constexpr int n = 60;
  std::vector<double> difference(2 * n + 1);
  const WheelRailPair side(wheel, rail, track, true);
  for (std::size_t k = 0; k < difference.size(); ++k) {
    WheelsetPosition p;  // the standard counts displacements at the rails
    p.lateral_shift = amplitude * (static_cast<double>(k) - n) / n;
    const WheelsetGeometry g = stand_at_rails(side, p);
    if (!g.stands) return no_place;
    difference[k] = g.rolling_radius_difference();
  }
  return conicity_of(difference, amplitude, track);
}

double conicity_of(const std::vector<double>& difference, double amplitude, const TrackGeometry& track) {
  // y'' = -delta_r(y) / (2 b0 r0), nominal distance of the contact points 1.5 m
  const double base = track.flange_back + 2.0 * track.tape_circle, n = 0.5 * static_cast<double>(difference.size() - 1);
  const auto delta_r = [&](double y) {
    const double x = std::clamp((y / amplitude + 1.0) * n, 0.0, 2.0 * n - 1e-9);
    const auto k = static_cast<std::size_t>(x);
    const double t = x - static_cast<double>(k);
    return (1.0 - t) * difference[k] + t * difference[k + 1];
  };
  // integrate in distance along the track from the amplitude at rest until the velocity changes sign twice
  double y = amplitude, v = 0.0, s = 0.0, last_v = -1.0;
  const double scale = track.radius * base, ds = 2.0 * std::numbers::pi * std::sqrt(scale / 2.0 / 0.2) / 20000.0;
  int turns = 0;
  for (long step = 0; step < 4000000; ++step) {
    v -= 0.5 * ds * delta_r(y) / scale;
    y += ds * v;
    v -= 0.5 * ds * delta_r(y) / scale;
    s += ds;
    if (step > 10 && v * last_v < 0.0 && ++turns == 2) break;
    last_v = v;
  }
  // Klingel: L = 2 pi sqrt(r0 2 b0 / (2 lambda))
  const double k = 2.0 * std::numbers::pi / s;
  return 0.5 * k * k * scale;
}

}  // namespace epafi
