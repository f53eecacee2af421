#include "detection/profiles/wheel_rail.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "detection/surfaces/surface_gap.h"

namespace epafi {
namespace {

constexpr double scan_step = 0.4e-3;    // the jump regions of S1002 on UIC60 are 5 mm apart
constexpr double table_step = 0.05e-3;  // of the rail's heights in the scan

constexpr int most_steps = 12;
constexpr double nowhere = 1.0;  // gap where one of the surfaces is not met [m]
constexpr double steepest =
    0.03;  // square of the cosine to the plane's normal: beyond 80 degrees it is no height above it
constexpr double not_met = std::numeric_limits<double>::quiet_NaN();
constexpr double small_step = 1e-7;  // of a Newton iteration [m]: the next would be below 1e-12 on a radius of 10 mm

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
  make_tables();
  place({});
}

void WheelRailPair::make_tables() {
  auto tables = std::make_shared<Tables>();
  const auto scanned = static_cast<std::size_t>((wheel_.y_max() - wheel_.y_min()) / scan_step) + 1;
  for (std::size_t k = 0; k < scanned; ++k) {
    const Profile::Value w = wheel_.at(wheel_.y_min() + scan_step * static_cast<double>(k));
    tables->wheel.push_back({track_.radius + w.z, w.slope});
  }
  const auto count = static_cast<std::size_t>((rail_.y_max() - rail_.y_min()) / table_step) + 2;
  for (std::size_t k = 0; k < count; ++k)
    tables->rail.push_back(rail_.at(rail_.y_min() + table_step * static_cast<double>(k)).z);
  tables_ = std::move(tables);
}

WheelRailPair WheelRailPair::on_side(bool right) const {
  WheelRailPair out = *this;
  out.mirror_ = right ? 1.0 : -1.0;
  out.place({});
  return out;
}

std::vector<double> WheelRailPair::scan(double& from) const {
  const auto first = static_cast<std::size_t>(std::max(0.0, std::ceil((scan_from_ - wheel_.y_min()) / scan_step)));
  from = wheel_.y_min() + scan_step * static_cast<double>(first);
  const std::vector<double>& rail = tables_->rail;
  std::vector<double> gap;
  for (std::size_t k = first; k < tables_->wheel.size(); ++k) {
    const double y = wheel_.y_min() + scan_step * static_cast<double>(k);
    if (y > scan_to_) break;
    const auto& [R, slope] = tables_->wheel[k];
    const double t = slope * tan_yaw_, c = 1.0 / std::sqrt(1.0 + t * t), x = -R * t * c, z = R * c, side = tape_ + y;
    const double py = centre_.y() + turn_(1, 0) * x + turn_(1, 1) * side + turn_(1, 2) * z,
                 pz = centre_.z() + turn_(2, 1) * side + turn_(2, 2) * z;
    const double at = (axis_ - py - rail_.y_min()) / table_step,
                 inside = std::clamp(at, 0.0, static_cast<double>(rail.size()) - 1.000001);
    const auto m = static_cast<std::size_t>(inside);
    gap.push_back(rail[m] + (at - static_cast<double>(m)) * (rail[m + 1] - rail[m]) - pz);
  }
  return gap;
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
  const double dt = w.second * tan_yaw_, dc = -t * dt * c * c * c;
  const Vec3 dp = turn_ * Vec3(-w.slope * t * c - R * (dt * c + t * dc), 1.0, w.slope * c + R * dc);
  const Profile::Value r = rail_.at(axis_ - p.y());
  return {p, r.z - p.z(), -r.slope * dp.y() - dp.z()};
}

double WheelRailPair::refine(double y) const {
  // where the slope passes zero, by secants kept between the ends (Illinois); the ends rise on both sides of a minimum
  double low = y - scan_step, high = y + scan_step, f_low = locus(low).slope, f_high = locus(high).slope;
  if (f_low >= 0.0 || f_high <= 0.0) return f_low >= 0.0 ? low : high;
  int side = 0;
  for (int k = 0; k < 60 && high - low > 1e-12; ++k) {
    const double middle = (f_low * high - f_high * low) / (f_low - f_high), f = locus(middle).slope;
    if (f == 0.0 || middle <= low || middle >= high) return middle;
    if (f < 0.0) {
      low = middle;
      f_low = f;
      if (side == -1) f_high *= 0.5;
      side = -1;
    } else {
      high = middle;
      f_high = f;
      if (side == 1) f_low *= 0.5;
      side = 1;
    }
    if (std::abs(f) < 1e-12) return middle;
  }
  return 0.5 * (low + high);
}

double WheelRailPair::clearance() const {
  double from = 0.0;
  const std::vector<double> gap = scan(from);
  if (gap.empty()) return std::numeric_limits<double>::infinity();
  const auto lowest = static_cast<double>(std::min_element(gap.begin(), gap.end()) - gap.begin());
  return locus(refine(from + lowest * scan_step)).gap;
}

WheelRailPair::Missing WheelRailPair::missing() const {
  double from = 0.0;
  const std::vector<double> gap = scan(from);
  if (gap.empty()) return Missing::apart;
  if (!minima(0.0).empty()) return Missing::nothing;
  const auto lowest = static_cast<double>(std::min_element(gap.begin(), gap.end()) - gap.begin());
  const double y = from + lowest * scan_step;
  return y - wheel_.y_min() < scan_step || wheel_.y_max() - y < scan_step ? Missing::wheel_ends : Missing::rail_ends;
}

bool WheelRailPair::has_gauge_face() const {
  const Profile::Value end = rail_.at(rail_.y_max());
  constexpr double flank = 10.0;  // slope: from there on 4 mm of height are less than half a millimetre of gauge
  return end.z >= track_.gauge_height || (end.slope > flank && end.z > 0.7 * track_.gauge_height);
}

void WheelRailPair::touch() {
  if (const double way = clearance(); std::isfinite(way)) centre_.z() += way;
}

void WheelRailPair::lower(double depth) {
  centre_.z() += depth - depth_;
  depth_ = depth;
}

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
  out.y_wheel = y;
  out.y_rail = axis_ - at.point.y();
  out.rolling_radius = track_.radius + w.z;
  // z down: the wheel is convex where its radius curves down across the tread, the rail where it falls away
  out.wheel_curvature = -w.second * std::pow(std::cos(wheel_angle), 3);
  out.rail_curvature = r.second * c * c * c;
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
  for (int k = 0; k < most_steps; ++k) {
    const Vec3 p = o + s * t + z * n;
    const Profile::Value r = rail_.at(axis_ - p.y());
    const double f = p.z() - r.z, df = n.z() + r.slope * n.y();
    if (!(df * std::abs(df) > steepest * (1.0 + r.slope * r.slope))) break;
    const double step = f / df;
    z -= step;
    if (std::abs(step) < small_step) return z;
  }
  return not_met;
}

double WheelRailPair::wheel_height(const Plane& plane, double x, double s, double z) const {
  const auto& [o, t, n] = plane;
  const Vec3 base = turn_.transpose() * (o + x * Vec3::UnitX() + s * t - centre_), d = turn_.transpose() * n;
  for (int k = 0; k < most_steps; ++k) {
    const Vec3 p = base + z * d;
    const Profile::Value w = wheel_.at(p.y() - tape_);
    const double rho = std::hypot(p.x(), p.z());
    const double f = rho - track_.radius - w.z, df = (p.x() * d.x() + p.z() * d.z()) / rho - w.slope * d.y();
    if (!(df * std::abs(df) > steepest * (1.0 + w.slope * w.slope))) break;
    const double step = f / df;
    z -= step;
    if (std::abs(step) < small_step) return z;
  }
  return not_met;
}

bool WheelRailPair::sample(const Plane& plane, std::size_t k, Sample& here, GapProfile& g) const {
  const auto& [o, t, n] = plane;
  const double s = g.y(k);
  const double zr = rail_height(plane, s, here.rail);
  // the lowest point along x: where the wheel's normal has no x part; x follows the slope of the wheel's profile
  double zw = wheel_height(plane, here.x, s, here.wheel);
  if (std::isnan(zr) || std::isnan(zw)) return false;
  const Vec3 p = turn_.transpose() * (o + here.x * Vec3::UnitX() + s * t + zw * n - centre_);
  const Profile::Value w = wheel_.at(p.y() - tape_);
  const double rho = std::hypot(p.x(), p.z());
  const Vec3 normal = turn_ * Vec3(p.x() / rho, -w.slope, p.z() / rho);
  const double step = -normal.x() * rho, x = here.x + step, curvature = 1.0 / (rho * normal.dot(n));
  constexpr double parabola = 2e-5;  // a step along x [m] up to which the wheel's height follows its curvature to 1e-15
  zw = std::abs(step) < parabola ? zw + 0.5 * curvature * step * step : wheel_height(plane, x, s, zw);
  if (std::isnan(zw)) return false;
  here = {zr, zw, x};
  g.curvature_x[k] = curvature;
  g.centre_x[k] = x;
  g.gap[k] = zr - zw + depth_ * n.z();
  return true;
}

void WheelRailPair::add_profile(ContactRegion& region) const {
  const Plane plane = plane_of(region);
  GapProfile& g = region.profile;
  const auto count = static_cast<std::size_t>(2.0 * sampling_.reach / sampling_.step) + 1;
  g.start = -sampling_.reach;
  g.step = sampling_.step;
  g.gap.resize(count);
  g.curvature_x.resize(count);
  g.centre_x.resize(count);
  // walk both ways from the middle: a parabola through the last three heights is a good guess of the next
  const std::size_t middle = count / 2;
  for (const int way : {1, -1}) {
    Sample here{0.0, -region.offset, 0.0}, last = here, before = here;
    const auto place = [&](std::size_t m) { return way > 0 ? middle + m : middle - m; };
    std::size_t m = 0;
    while (m <= middle && sample(plane, place(m), here, g) && g.gap[place(m)] < sampling_.until) {
      if (m == 0) last = before = here;
      const Sample next{3.0 * (here.rail - last.rail) + before.rail, 3.0 * (here.wheel - last.wheel) + before.wheel,
                        3.0 * (here.x - last.x) + before.x};
      before = last;
      last = here;
      ++m;
      if (m > 2) here = next;
    }
    // from there on it goes on as it was, opening
    for (std::size_t rest = m; rest <= middle; ++rest) {
      const std::size_t q = place(rest), from = place(rest > 0 ? rest - 1 : 0);
      if (rest == m && g.gap[q] >= sampling_.until) continue;
      g.gap[q] = 1.1 * std::max(g.gap[from], sampling_.step);
      g.curvature_x[q] = g.curvature_x[from];
      g.centre_x[q] = g.centre_x[from];
    }
  }
}

void WheelRailPair::part(ContactRegion& region, const ContactRegion& other) const {
  GapProfile& g = region.profile;
  const Plane plane = plane_of(region);
  const Vec3 there(other.point.x(), mirror_ * other.point.y(), other.point.z());
  const double s = (there - plane.origin).dot(plane.t);
  const std::size_t middle = g.size() / 2;
  const auto place = [&](std::size_t m) { return s > 0.0 ? middle + m : middle - m; };
  const auto between = std::min(static_cast<std::size_t>(std::abs(s) / g.step), middle);
  std::size_t hill = 0;
  for (std::size_t m = 1; m <= between; ++m)
    if (g.gap[place(m)] > g.gap[place(hill)]) hill = m;
  for (std::size_t m = hill + 1; m <= middle; ++m)
    g.gap[place(m)] = std::max(g.gap[place(m)], 1.1 * std::max(g.gap[place(m - 1)], g.step));
}

std::vector<std::pair<double, double>> WheelRailPair::minima(double reach) const {
  double from = 0.0;
  const std::vector<double> gap = scan(from);
  std::vector<std::pair<double, double>> out;  // refined gap and place
  if (gap.empty()) return out;
  const double lowest = *std::min_element(gap.begin(), gap.end());
  // what touches first at the end of a profile touches with a corner that is none
  if (std::min(gap.front(), gap.back()) <= lowest) return out;
  for (std::size_t k = 1; k + 1 < gap.size(); ++k) {
    if (!(gap[k] <= gap[k - 1] && gap[k] < gap[k + 1]) || gap[k] > lowest + 2.0 * reach) continue;
    const double y = refine(from + static_cast<double>(k) * scan_step);
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
    out.back().point.y() *= mirror_;
    out.back().angle *= mirror_;
  }
  return out;
}

std::vector<ContactRegion> WheelRailPair::find_regions(double reach) const {
  std::vector<ContactRegion> out = regions_at(minima(reach), reach);
  if (!out.empty()) add_profile(out.front());
  return out;
}

std::optional<ContactRegion> WheelRailPair::deepest() const {
  const std::vector<ContactRegion> all = regions_at(minima(2e-4), 0.0);
  return all.empty() ? std::nullopt : std::optional(all.front());
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
  f.dx = dx;
  f.dy = dy;
  f.nx = nx;
  f.ny = ny;
  f.origin = region.point;
  f.curvature_x = region.curvature_x;
  f.curvature_y = region.curvature_y;
  f.gap.assign(nx * ny, nowhere);
  const Plane plane = plane_of(region);
  // rows from the one nearest to the origin outwards, cells likewise: the last heights are good guesses
  const auto nearest = [](double middle, double step, std::size_t n) {
    return static_cast<std::size_t>(
        std::clamp(-middle / step + 0.5 * static_cast<double>(n), 0.0, static_cast<double>(n) - 1.0));
  };
  const std::size_t i0 = nearest(cx, dx, nx), j0 = nearest(cy, dy, ny);
  for (const bool up : {true, false}) {
    double zr = 0.0, first = 0.0;
    for (std::size_t j = up ? j0 : j0 - 1; j < ny; up ? ++j : --j) {
      const double s = cy + f.y(j);
      zr = rail_height(plane, s, zr);
      if (std::isnan(zr)) break;
      first = wheel_height(plane, cx + f.x(i0), s, first);
      if (std::isnan(first)) break;
      for (const bool right : {true, false}) {
        double zw = first;
        for (std::size_t i = right ? i0 : i0 - 1; i < nx; right ? ++i : --i) {
          zw = wheel_height(plane, cx + f.x(i), s, zw);
          if (std::isnan(zw)) break;
          f.gap[j * nx + i] = zr - zw + depth_ * plane.n.z();
        }
      }
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
  ContactRegion out = place_at(region, y, angle);
  add_profile(out);
  return out;
}

ContactRegion WheelRailPair::place_at(const ContactRegion& region, double y, double angle) const {
  ContactRegion out = region;
  const Plane plane = plane_of(region);
  Vec3 p = plane.origin + y * plane.t + rail_height(plane, y, 0.0) * plane.n;
  const GapProfile& g = region.profile;
  if (g.size() > 1) {
    const auto value = [&](const std::vector<double>& v, double place) {
      const double at = std::clamp((place - g.start) / g.step, 0.0, static_cast<double>(g.size()) - 1.000001);
      const auto k = static_cast<std::size_t>(at);
      return v[k] + (at - static_cast<double>(k)) * (v[k + 1] - v[k]);
    };
    // x is where the wheel's point below that of the rail is lowest
    const double deep = std::max(0.0, depth_ * plane.n.z() - value(g.gap, y)), lean = -plane.n.y() / plane.n.z();
    p.x() += value(g.centre_x, y + lean * deep);
  }
  const Vec3 q = turn_.transpose() * (p - centre_);
  out.point = Vec3(p.x(), mirror_ * p.y(), p.z());
  out.y_rail = axis_ - p.y();
  out.y_wheel = q.y() - tape_;
  out.angle = angle;
  out.rolling_radius = track_.radius + wheel_.at(out.y_wheel).z;
  return out;
}

WheelsetGeometry stand_on_rails(const Profile& wheel, const Profile& rail, const TrackGeometry& track,
                                WheelsetPosition p) {
  return stand_on_rails(WheelRailPair(wheel, rail, track, true), p);
}

}  // namespace epafi
