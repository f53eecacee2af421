#include "detection/profiles/track.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace epafi {
namespace {

/// Nodes and weights of Gauss on [-1, 1], half of them.
constexpr std::array<std::pair<double, double>, 4> gauss{{{0.1834346424956498, 0.3626837833783620},
                                                          {0.5255324099163290, 0.3137066458778873},
                                                          {0.7966664774136267, 0.2223810344533745},
                                                          {0.9602898564975363, 0.1012285362903763}}};

double interpolate(const std::vector<double>& x, const std::vector<double>& y, double at) {
  if (y.empty()) return 0.0;
  if (at <= x.front()) return y.front();
  if (at >= x.back()) return y.back();
  const auto k = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin());
  const double t = (at - x[k - 1]) / (x[k] - x[k - 1]);
  return (1.0 - t) * y[k - 1] + t * y[k];
}

}  // namespace

double Track::share(double s) const {
  if (curve.radius == 0.0 || s <= curve.start) return 0.0;
  return curve.transition > 0.0 ? std::min(1.0, (s - curve.start) / curve.transition) : 1.0;
}

double Track::curvature(double s) const { return curve.radius == 0.0 ? 0.0 : share(s) / curve.radius; }

double Track::heading(double s) const {
  if (curve.radius == 0.0 || s <= curve.start) return 0.0;
  const double along = s - curve.start, T = curve.transition;
  return (along < T ? 0.5 * along * along / T : along - 0.5 * T) / curve.radius;
}

Pose Track::frame(double s) const {
  Pose at;
  at.position = Vec3(std::min(s, curve.radius == 0.0 ? s : curve.start), 0.0, 0.0);
  if (curve.radius != 0.0 && s > curve.start) {
    // the clothoid by Gauss with eight points (1e-13 m at 0.1 rad of heading), then the circle in closed form
    const double end = std::min(s, curve.start + curve.transition), half = 0.5 * (end - curve.start),
                 middle = 0.5 * (end + curve.start);
    for (const auto& [node, weight] : gauss) {
      for (const double place : {middle - half * node, middle + half * node}) {
        const double angle = heading(place);
        at.position += half * weight * Vec3(std::cos(angle), std::sin(angle), 0.0);
      }
    }
    const double from = heading(end), to = heading(s);
    if (s > end) at.position += curve.radius * Vec3(std::sin(to) - std::sin(from), std::cos(from) - std::cos(to), 0.0);
  }
  // the rails stand 1.5 m apart; in a curve to the right the left one is higher: y turns towards z
  const double lean =
      curve.radius == 0.0
          ? 0.0
          : std::copysign(std::asin(share(s) * curve.superelevation / (geometry.gauge + 0.07)), curve.radius);
  at.orientation = Quat(Eigen::AngleAxisd(heading(s), Vec3::UnitZ()) * Eigen::AngleAxisd(lean, Vec3::UnitX()));
  return at;
}

double Track::distance_of(const Vec3& p) const {
  if (curve.radius == 0.0 || p.x() <= curve.start) return p.x();
  // from the angle about the circle's centre, then Newton along the line
  const Pose join = frame(curve.start + curve.transition);
  const double first = heading(curve.start + curve.transition);
  const Vec3 centre = join.position + curve.radius * Vec3(-std::sin(first), std::cos(first), 0.0), arm = p - centre;
  const double side = std::copysign(1.0, curve.radius);
  const double angle = std::atan2(side * arm.x(), -side * arm.y());
  double s = curve.start + curve.transition + curve.radius * (angle - first);
  if (s < curve.start) s = p.x();
  for (int k = 0; k < 20; ++k) {
    const Pose at = frame(s);
    const Vec3 t(std::cos(heading(s)), std::sin(heading(s)), 0.0), n(-t.y(), t.x(), 0.0), d = p - at.position;
    const double step = d.dot(t) / std::max(0.1, 1.0 - curvature(s) * d.dot(n));
    s += step;
    if (std::abs(step) < 1e-12) break;
  }
  return s;
}

RailShift Track::shift(double s, bool right) const {
  RailShift out;
  const double side = right ? 1.0 : -1.0;
  if (wave.lateral != 0.0 || wave.vertical != 0.0 || wave.cross_level != 0.0) {
    const double sine = std::sin(2.0 * std::numbers::pi * s / wave.wavelength);
    out.y += wave.lateral * sine;
    out.z += (wave.vertical + 0.5 * side * wave.cross_level) * sine;
  }
  const MeasuredTrack& m = measured;
  if (m.distance.empty()) return out;
  out.y += interpolate(m.distance, m.lateral, s) + 0.5 * side * interpolate(m.distance, m.gauge, s);
  out.z += interpolate(m.distance, m.vertical, s) + 0.5 * side * interpolate(m.distance, m.cross_level, s);
  return out;
}

Vec3 Track::direction(double s, bool right, double beside) const {
  const bool level =
      wave.lateral == 0.0 && wave.vertical == 0.0 && wave.cross_level == 0.0 && measured.distance.empty();
  if (curve.radius == 0.0 && level) return Vec3::UnitX();
  constexpr double h = 5e-3;  // half of it is a patch
  const auto rail = [&](double at) {
    const RailShift off = shift(at, right);
    return frame(at).to_world(Vec3(0.0, (right ? beside : -beside) + off.y, off.z));
  };
  return (frame(s).orientation.conjugate() * (rail(s + h) - rail(s - h))).normalized();
}

}  // namespace epafi
