#include "detection/profiles/wheel_rail.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "detection/surfaces/surface_gap.h"

namespace epafi {
namespace {

constexpr double scan_step = 0.4e-3;  // the jump regions of S1002 on UIC60 are 5 mm apart

}  // namespace

WheelRailPair::WheelRailPair(const Profile& wheel, const Profile& rail, const TrackGeometry& track, bool right)
    : wheel_(wheel), rail_(rail), track_(track), mirror_(right ? 1.0 : -1.0) {
  // the gauge face stands at half the gauge: where the rail is gauge_height below its top, on the gauge side
  double low = 0.0, high = rail.y_max();
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (rail.at(middle).z < track.gauge_height ? low : high) = middle;
  }
  axis_ = 0.5 * track.gauge + low;
  tape_ = 0.5 * track.flange_back + track.tape_circle;
  place({});
}

void WheelRailPair::place(const WheelsetPosition& p) {
  const double yaw = mirror_ * p.yaw, roll = mirror_ * p.roll;
  const double cy = std::cos(yaw), sy = std::sin(yaw), cr = std::cos(roll), sr = std::sin(roll);
  Mat3 about_z, about_x;
  about_z << cy, -sy, 0, sy, cy, 0, 0, 0, 1;
  about_x << 1, 0, 0, 0, cr, -sr, 0, sr, cr;
  turn_ = about_z * about_x;
  tan_yaw_ = sy / cy;
  centre_ = Vec3(0.0, mirror_ * p.lateral_shift, -track_.radius + p.height);
  depth_ = 0.0;
  // where wheel and rail lie above each other; a little beyond the flank, so that a flange contact is no end of the
  // scan
  const double shift = centre_.y() + tape_;
  scan_from_ = std::max(wheel_.y_min(), axis_ - rail_.y_max() - 3e-3 - shift);
  scan_to_ = std::min(wheel_.y_max(), axis_ - 0.9 * rail_.y_min() - shift);
}

WheelRailPair::Locus WheelRailPair::locus(double y) const {
  // the wheel's points of one lateral coordinate are a circle; its lowest point over the track turns with the yaw:
  // its x is -R R' tan(yaw), which keeps the normal in the plane x = const
  const Profile::Value w = wheel_.at(y);
  const double R = track_.radius + w.z, t = w.slope * tan_yaw_, c = 1.0 / std::sqrt(1.0 + t * t);
  const Vec3 p = centre_ + turn_ * Vec3(-R * t * c, tape_ + y, R * c);
  return {p, rail_.at(axis_ - p.y()).z - p.z()};
}

double WheelRailPair::refine(double y, double step) const {
  double low = y - step, high = y + step;
  const double golden = 0.61803398874989485;
  double a = high - golden * (high - low), b = low + golden * (high - low), fa = locus(a).gap, fb = locus(b).gap;
  for (int k = 0; k < 40 && high - low > 1e-9; ++k) {
    if (fa < fb)
      high = b, b = a, fb = fa, a = high - golden * (high - low), fa = locus(a).gap;
    else
      low = a, a = b, fa = fb, b = low + golden * (high - low), fb = locus(b).gap;
  }
  return 0.5 * (low + high);
}

double WheelRailPair::clearance() const {
  double best = 1e9, where = scan_from_;
  for (double y = scan_from_; y <= scan_to_; y += scan_step) {
    const double gap = locus(y).gap;
    if (gap < best) best = gap, where = y;
  }
  return locus(refine(where, scan_step)).gap;
}

void WheelRailPair::touch() { centre_.z() += clearance(); }

void WheelRailPair::lower(double depth) { centre_.z() += depth - depth_, depth_ = depth; }

ContactRegion WheelRailPair::region_at(double y, double deepest) const {
  const Locus at = locus(y);
  const Profile::Value w = wheel_.at(y), r = rail_.at(axis_ - at.point.y());
  ContactRegion out;
  out.point = at.point;
  out.point.z() = r.z;  // on the rail
  out.angle = std::atan(-r.slope);
  const double c = std::cos(out.angle),
               wheel_angle = std::atan(w.slope + std::tan(std::atan2(turn_(2, 1), turn_(1, 1))));
  out.offset = (at.gap - deepest) * c;
  out.y_wheel = y, out.y_rail = axis_ - at.point.y();
  out.rolling_radius = track_.radius + w.z;
  // z down: the wheel is convex where its radius curves down across the tread, the rail where it falls away
  out.wheel_curvature = -w.second * std::pow(std::cos(wheel_angle), 3), out.rail_curvature = r.second * c * c * c;
  out.curvature_y = out.wheel_curvature + out.rail_curvature;
  out.curvature_x = std::cos(wheel_angle) / out.rolling_radius;
  return out;
}

WheelRailPair::Plane WheelRailPair::plane_of(const ContactRegion& r) const {
  const double angle = mirror_ * r.angle;
  const Vec3 t(0.0, std::cos(angle), std::sin(angle));
  return {Vec3(r.point.x(), mirror_ * r.point.y(), r.point.z()), t, Vec3(0.0, -t.z(), t.y())};
}

double WheelRailPair::rail_height(const Plane& plane, double s, double z) const {
  const auto& [o, t, n] = plane;
  for (int k = 0; k < 8; ++k) {
    const Vec3 p = o + s * t + z * n;
    const Profile::Value r = rail_.at(axis_ - p.y());
    const double f = p.z() - r.z, df = n.z() + r.slope * n.y();
    const double step = f / df;
    z -= step;
    if (std::abs(step) < 1e-13) break;
  }
  return z;
}

double WheelRailPair::wheel_height(const Plane& plane, double x, double s, double z) const {
  const auto& [o, t, n] = plane;
  const Vec3 base = turn_.transpose() * (o + x * Vec3::UnitX() + s * t - centre_), d = turn_.transpose() * n;
  for (int k = 0; k < 8; ++k) {
    const Vec3 p = base + z * d;
    const Profile::Value w = wheel_.at(p.y() - tape_);
    const double rho = std::hypot(p.x(), p.z());
    const double f = rho - track_.radius - w.z, df = (p.x() * d.x() + p.z() * d.z()) / rho - w.slope * d.y();
    const double step = f / df;
    z -= step;
    if (std::abs(step) < 1e-13) break;
  }
  return z;
}

void WheelRailPair::add_profile(ContactRegion& region) const {
  const Plane plane = plane_of(region);
  const auto& [o, t, n] = plane;
  GapProfile& g = region.profile;
  const auto count = static_cast<std::size_t>(2.0 * sampling_.reach / sampling_.step) + 1;
  g.start = -sampling_.reach, g.step = sampling_.step;
  g.gap.resize(count), g.curvature_x.resize(count), g.centre_x.resize(count);
  // walk both ways from the middle: the last heights are good guesses
  const std::size_t middle = count / 2;
  for (const int way : {1, -1}) {
    double zr = 0.0, zw = -region.offset, x = 0.0;
    for (std::size_t m = 0; m <= middle; ++m) {
      const std::size_t k = way > 0 ? middle + m : middle - m;
      const double s = g.y(k);
      zr = rail_height(plane, s, zr);
      // the lowest point along x: where the wheel's normal has no x part; x follows the slope of the wheel's profile
      for (int again = 0; again < 1; ++again) {
        zw = wheel_height(plane, x, s, zw);
        const Vec3 p = turn_.transpose() * (o + x * Vec3::UnitX() + s * t + zw * n - centre_);
        const Profile::Value w = wheel_.at(p.y() - tape_);
        const double rho = std::hypot(p.x(), p.z());
        const Vec3 normal = turn_ * Vec3(p.x() / rho, -w.slope, p.z() / rho);
        g.curvature_x[k] = 1.0 / (rho * normal.dot(n));
        x -= normal.x() * rho;
      }
      zw = wheel_height(plane, x, s, zw);
      g.centre_x[k] = x;
      g.gap[k] = zr - zw + depth_ * n.z();
      if (g.gap[k] < sampling_.until) continue;
      for (std::size_t rest = m + 1; rest <= middle; ++rest) {
        const std::size_t q = way > 0 ? middle + rest : middle - rest;
        g.gap[q] = g.gap[k] * (1.0 + 0.1 * static_cast<double>(rest - m)), g.curvature_x[q] = g.curvature_x[k],
        g.centre_x[q] = x;
      }
      break;
    }
  }
}

std::vector<std::pair<double, double>> WheelRailPair::minima(double reach) const {
  std::vector<double> gap;
  const auto count = static_cast<std::size_t>(std::max(0.0, (scan_to_ - scan_from_) / scan_step)) + 1;
  for (std::size_t k = 0; k < count; ++k) gap.push_back(locus(scan_from_ + static_cast<double>(k) * scan_step).gap);
  const double lowest = *std::min_element(gap.begin(), gap.end());
  std::vector<std::pair<double, double>> out;  // refined gap and place
  for (std::size_t k = 1; k + 1 < count; ++k) {
    if (!(gap[k] <= gap[k - 1] && gap[k] < gap[k + 1]) || gap[k] > lowest + 2.0 * reach) continue;
    const double y = refine(scan_from_ + static_cast<double>(k) * scan_step, scan_step);
    out.emplace_back(locus(y).gap, y);
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<ContactRegion> WheelRailPair::regions_at(const std::vector<std::pair<double, double>>& minima,
                                                     double reach) const {
  std::vector<ContactRegion> out;
  for (const auto& [gap, y] : minima) {
    if (gap > minima.front().first + reach) break;
    out.push_back(region_at(y, minima.front().first));
    out.back().point.y() *= mirror_, out.back().angle *= mirror_;
  }
  return out;
}

std::vector<ContactRegion> WheelRailPair::find_regions(double reach) const {
  std::vector<ContactRegion> out = regions_at(minima(reach), reach);
  if (!out.empty()) add_profile(out.front());
  return out;
}

double WheelRailPair::touch(double reach, std::vector<ContactRegion>& regions) {
  auto places = minima(reach);
  regions.clear();
  if (places.empty()) return 0.0;
  // every vertical gap changes by the same: the places stay
  const double clearance = places.front().first;
  centre_.z() += clearance;
  for (auto& [gap, y] : places) gap -= clearance;
  regions = regions_at(places, reach);
  return clearance;
}

GapField WheelRailPair::field(const ContactRegion& region, double cx, double cy, double dx, double dy, std::size_t nx,
                              std::size_t ny) const {
  GapField f;
  f.dx = dx, f.dy = dy, f.nx = nx, f.ny = ny, f.origin = region.point;
  f.curvature_x = region.curvature_x, f.curvature_y = region.curvature_y;
  f.gap.resize(nx * ny);
  const Plane plane = plane_of(region);
  double zr = 0.0;
  for (std::size_t j = 0; j < ny; ++j) {
    const double s = cy + f.y(j);
    zr = rail_height(plane, s, zr);
    double zw = zr;
    for (std::size_t i = 0; i < nx; ++i) {
      zw = wheel_height(plane, cx + f.x(i), s, zw);
      f.gap[j * nx + i] = zr - zw + depth_ * plane.n.z();
    }
  }
  return f;
}

std::unique_ptr<GapOperator> WheelRailPair::gaps_between(GapMethod method, std::span<const Vec3> nodes,
                                                         std::span<const std::array<std::uint32_t, 3>> first,
                                                         std::span<const std::array<std::uint32_t, 3>> second,
                                                         double band) const {
  return make_gap_operator(method, nodes, first, second, band);
}

double WheelRailPair::angle_at(const ContactRegion& region, double y) const {
  const Plane plane = plane_of(region);
  const Vec3 p = plane.origin + y * plane.t + rail_height(plane, y, 0.0) * plane.n;
  return mirror_ * std::atan(-rail_.at(axis_ - p.y()).slope);
}

ContactRegion WheelRailPair::moved(const ContactRegion& region, double y, double angle) const {
  ContactRegion out = region;
  const Plane plane = plane_of(region);
  Vec3 p = plane.origin + y * plane.t + rail_height(plane, y, 0.0) * plane.n;
  const auto x = region.profile.size() > 0
                     ? static_cast<std::size_t>(std::clamp((y - region.profile.start) / region.profile.step, 0.0,
                                                           static_cast<double>(region.profile.size() - 1)))
                     : 0;
  if (region.profile.size() > 0) p.x() += region.profile.centre_x[x];
  const Vec3 q = turn_.transpose() * (p - centre_);
  out.point = Vec3(p.x(), mirror_ * p.y(), p.z());
  out.y_rail = axis_ - p.y(), out.y_wheel = q.y() - tape_;
  out.angle = angle;
  out.rolling_radius = track_.radius + wheel_.at(out.y_wheel).z;
  add_profile(out);
  return out;
}

WheelsetGeometry stand_on_rails(const Profile& wheel, const Profile& rail, const TrackGeometry& track,
                                WheelsetPosition p) {
  WheelRailPair left(wheel, rail, track, false), right(wheel, rail, track, true);
  for (int k = 0; k < 30; ++k) {
    left.place(p), right.place(p);
    const double gl = left.clearance(), gr = right.clearance();
    // sink by the mean, turn by the difference over the distance of the contacts
    p.height += 0.5 * (gl + gr);
    p.roll += (gr - gl) / (2.0 * right.rail_axis());
    if (std::abs(gl) + std::abs(gr) < 1e-12) break;
  }
  left.place(p), right.place(p);
  return {p, left.find_regions(2e-4).front(), right.find_regions(2e-4).front()};
}

double equivalent_conicity(const Profile& wheel, const Profile& rail, const TrackGeometry& track, double amplitude) {
  // y'' = -delta_r(y) / (2 b0 r0): time to swing from the amplitude to the other side follows from the energy of the
  // oscillator
  constexpr int n = 60;
  const double base = track.flange_back + 2.0 * track.tape_circle;  // nominal distance of the contact points, 1.5 m
  std::vector<double> difference(2 * n + 1);
  for (int k = -n; k <= n; ++k) {
    // the standard counts displacements at the rails, where rolling about the axle's middle moves the wheels sideways
    // by roll r0
    const double y = amplitude * k / n;
    WheelsetPosition p;
    p.lateral_shift = y;
    WheelsetGeometry g = stand_on_rails(wheel, rail, track, p);
    for (int again = 0; again < 3; ++again) {
      p = g.position;
      p.lateral_shift = y + p.roll * track.radius;
      g = stand_on_rails(wheel, rail, track, p);
    }
    difference[static_cast<std::size_t>(k + n)] = g.rolling_radius_difference();
  }
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
