#include <algorithm>

#include "detection/narrow/pairs/hollow_pairs.h"

namespace epafi {
namespace {

/// Numbers of the wall's parts in the features of a pair.
enum WallPart : std::size_t { side_part = 1, start_part = 2, end_part = 3, solid_part = 4 };

constexpr std::size_t azimuths = 24;  // where the search of rims and sides begins
constexpr double spacing = 0.27;      // between two of them, or little more [rad]

/// Unit vectors across the axis, 15 degrees apart: by turning, so that no libm decides a bit of a run.
const std::array<Vec3, azimuths>& directions() {
  static const std::array<Vec3, azimuths> all = [] {
    constexpr double cosine = 0.96592582628906828675, sine = 0.25881904510252076235;
    std::array<Vec3, azimuths> out;
    out[0] = Vec3::UnitX();
    for (std::size_t k = 1; k < azimuths; ++k) {
      const Vec3& last = out[k - 1];
      out[k] = Vec3(cosine * last.x() - sine * last.y(), sine * last.x() + cosine * last.y(), 0.0).normalized();
    }
    return out;
  }();
  return all;
}

/// From direction k - 1 (u = -1) over k (0) to k + 1 (1).
Vec3 direction_near(std::size_t k, double u) {
  const auto& all = directions();
  const Vec3& middle = all[k];
  const Vec3& other = u < 0.0 ? all[(k + azimuths - 1) % azimuths] : all[(k + 1) % azimuths];
  const double share = std::abs(u);
  return ((1.0 - share) * middle + share * other).normalized();
}

/// Least f(u) on [-1, 1], where it has one minimum: golden section.
template <class F>
double least_between(const F& f) {
  constexpr double golden = 0.61803398874989484820;
  double low = -1.0, high = 1.0;
  double left = high - golden * (high - low), right = low + golden * (high - low);
  double at_left = f(left), at_right = f(right);
  for (int round = 0; round < 48; ++round) {
    if (at_left < at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - golden * (high - low);
      at_left = f(left);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + golden * (high - low);
      at_right = f(right);
    }
  }
  return 0.5 * (low + high);
}

/// A body in the wall's axes.
class Guest {
 public:
  Guest(const HollowGuest& guest, const HollowWall& wall, const PairQuery& q, ContactSink& sink)
      : guest_(guest),
        wall_(wall),
        q_(q),
        sink_(sink),
        at_(q.b.to_local(q.a.position)),
        turn_((q.b.orientation.conjugate() * q.a.orientation).toRotationMatrix()) {
    radius_ = std::sqrt(at_.x() * at_.x() + at_.y() * at_.y());
    size_ = guest.core.radius + guest.sweep;
  }

  void collide() {
    if (wall_.distance(at_) >= size_ + q_.reach) return;
    const bool outside = wall_.beyond_side(radius_, at_.z()) > 0.0;
    const bool above = std::abs(at_.z()) > wall_.half_length;
    if (outside || (wall_.closed && above)) {
      meet_solid();
    } else {
      meet_side();
      if (wall_.closed) meet_discs();
    }
    if (wall_.closed) return;
    for (const bool at_end : {false, true}) {
      const bool beyond = at_end ? at_.z() > wall_.half_length : at_.z() < -wall_.half_length;
      if (!outside || beyond) meet_rim(at_end);
    }
  }

 private:
  struct Point {
    Vec3 place;   ///< wall's axes, relative to the wall [m]
    Vec3 normal;  ///< unit, from the body to the wall, wall's axes
    double gap;
    double curvature;
    Feature feature;
  };

  void emit(const Point& p) {
    const Vec3 normal = q_.b.orientation * p.normal;
    sink_.add({p.gap, normal, q_.b.orientation * (p.place - at_), radius_of(p), p.feature});
  }

  /// The principal curvatures of a round body count, of others their contact radius.
  double radius_of(const Point& p) const {
    if (!q_.curvature) return 0.0;
    if (!guest_.round || !guest_.round->curved) return wall_contact_radius(guest_.contact_radius, p.curvature);
    const Vec3 d = turn_.transpose() * p.normal;
    const Vec3 around = Vec3(-p.normal.y(), p.normal.x(), 0.0);
    const auto [u, v] = Tangents(d);
    CurvatureAcross body(guest_.round->curved_support_of(guest_.round->shape, d).derivative, u, v, guest_.sweep);
    if (!(around.squaredNorm() > 0.0)) return hertz_radius(body, {});
    const Vec3 t = turn_.transpose() * around.normalized();
    const double tu = t.dot(u), tv = t.dot(v);
    const double own = body.uu * tu * tu + 2.0 * body.uv * tu * tv + body.vv * tv * tv;
    const double wall = std::max(p.curvature, -0.9 * own);
    CurvatureAcross across;
    across.uu = wall * tu * tu;
    across.uv = wall * tu * tv;
    across.vv = wall * tv * tv;
    return hertz_radius(body, across);
  }

  static double radius_at(const Vec3& x) { return std::sqrt(x.x() * x.x() + x.y() * x.y()); }
  Vec3 side_normal(const Vec3& azimuth) const { return wall_.along_z * azimuth - Vec3(0.0, 0.0, wall_.along_radius); }
  Vec3 support(const Vec3& d) const { return at_ + turn_ * guest_.core.support(turn_.transpose() * d); }

  /// A point of the core that may touch the inside of the side; false where it does not, or lies over an open rim.
  bool on_side(const Vec3& x, Feature feature, Point& out) const {
    const double r = radius_at(x), way = wall_.way_along(r, x.z());
    if (!(r > 0.0) || way < 0.0 || way > wall_.side_length) return false;
    const double over = wall_.beyond_side(r, x.z()), gap = -over - guest_.sweep;
    if (!(gap < q_.reach)) return false;
    if (!wall_.closed && over > std::min(way, wall_.side_length - way)) return false;  // it hangs over the rim
    const Vec3 n = side_normal(Vec3(x.x() / r, x.y() / r, 0.0));
    const double foot = wall_.radius_at(way);
    out = {x + (guest_.sweep + 0.5 * gap) * n, n, gap, foot > 0.0 ? -wall_.along_z / foot : 0.0, feature};
    return true;
  }

  void keep(std::vector<Point>& points) {
    if (points.empty()) return;
    static thread_local std::vector<PatchPoint> patch;
    patch.clear();
    std::size_t deepest = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (points[k].gap < points[deepest].gap) deepest = k;
      patch.push_back({points[k].place - at_, points[k].gap, static_cast<Feature>(k)});
    }
    Patch kept;
    keep_four(patch, points[deepest].normal, size_, kept);
    for (int k = 0; k < kept.count; ++k)
      emit(points[static_cast<std::size_t>(kept.point[static_cast<std::size_t>(k)].feature)]);
  }

  void meet_side() {
    static thread_local std::vector<Point> points;
    points.clear();
    Point p;
    for (std::size_t k = 0; k < guest_.corners.size(); ++k)
      if (on_side(at_ + turn_ * guest_.corners[k], static_cast<Feature>(k), p)) points.push_back(p);
    if (guest_.corners.empty()) furthest_across(points);
    if (guest_.one_point && points.size() > 1) points = {*std::ranges::min_element(points, {}, &Point::gap)};
    sink_.enter_part(side_part, Vec3::Zero());
    keep(points);
    sink_.leave_part(Vec3::Zero());
  }

  /// How far the body reaches across the side, by azimuth: its maxima are where the side holds it.
  void furthest_across(std::vector<Point>& points) const {
    const auto room = [&](const Vec3& azimuth) {
      const Vec3 x = support(side_normal(azimuth));
      return -side_normal(azimuth).dot(
          x - Vec3(wall_.start_radius * azimuth.x(), wall_.start_radius * azimuth.y(), -wall_.half_length));
    };
    std::array<double, azimuths> value;
    for (std::size_t k = 0; k < azimuths; ++k) value[k] = room(directions()[k]);
    for (std::size_t k = 0; k < azimuths; ++k) {
      const double before = value[(k + azimuths - 1) % azimuths], after = value[(k + 1) % azimuths];
      if (value[k] > before || value[k] > after) continue;
      if (value[k] - guest_.sweep - spacing * (radius_ + size_) > q_.reach) continue;  // it changes by less in between
      const Vec3 azimuth = direction_near(k, least_between([&](double u) { return room(direction_near(k, u)); }));
      add_support(azimuth, static_cast<Feature>(16 * points.size()), points);
    }
  }

  void add_support(const Vec3& azimuth, Feature first, std::vector<Point>& points) const {
    const Vec3 d = turn_.transpose() * side_normal(azimuth);
    const auto add = [&](const Vec3& x, Feature feature) {
      Point p;
      const auto is_there = [&](const Point& o) { return (o.place - p.place).squaredNorm() < near_square(); };
      if (on_side(x, feature, p) && std::ranges::none_of(points, is_there)) points.push_back(p);
    };
    add(support(side_normal(azimuth)), first);
    if (!guest_.facing) return;
    const FlatSide flat = guest_.facing(guest_.shape, d);
    for (int k = 0; k < flat.count; ++k)
      add(at_ + turn_ * flat.corner[static_cast<std::size_t>(k)], first + static_cast<Feature>(k) + 1);
  }

  /// Places that are nearer to each other are one.
  double near_square() const { return 1e-10 * size_ * size_; }

  void meet_discs() {
    for (const bool at_end : {false, true}) {
      PairQuery q{q_.a, q_.b, q_.reach, q_.curvature};
      q.b.position += q_.b.orientation * Vec3(0.0, 0.0, wall_.z_of_end(at_end));
      sink_.enter_part(at_end ? end_part : start_part, Vec3::Zero());
      guest_.on_plane(guest_.shape, HalfSpace{Vec3(0.0, 0.0, at_end ? -1.0 : 1.0)}, q, sink_);
      sink_.leave_part(Vec3::Zero());
    }
  }

  /// Contacts with the solid that the wall encloses, without those on an open end, where the rim counts if the body is
  /// over it.
  void meet_solid() {
    static thread_local ContactSet set;  // keeps its size
    set.clear();
    ContactSink found(set);
    found.begin(0, 1);
    const HollowSolid solid{wall_};
    guest_.on_solid(guest_.shape, solid, {q_.a, q_.b, q_.reach, false}, found);
    found.end();
    const Quat to_wall = q_.b.orientation.conjugate();
    sink_.enter_part(solid_part, Vec3::Zero());
    for (std::size_t k = 0; k < set.size(); ++k) {
      Point p{at_ + to_wall * set.arm[k], to_wall * set.normal[k], set.gap[k], 0.0, set.feature[k]};
      const double r = radius_at(p.place), way = std::clamp(wall_.way_along(r, p.place.z()), 0.0, wall_.side_length);
      const double foot = wall_.radius_at(way);
      const double outside =
          -p.normal.dot(side_normal(r > 0.0 ? Vec3(p.place.x() / r, p.place.y() / r, 0.0) : Vec3(Vec3::UnitX())));
      if (!wall_.closed && std::abs(at_.z()) > wall_.half_length && outside < 1.0 - 1e-9) continue;
      p.curvature = foot > 0.0 ? std::max(0.0, outside) * wall_.along_z / foot : 0.0;
      emit(p);
    }
    sink_.leave_part(Vec3::Zero());
  }

  struct AtPoint {
    double gap = infinity;       ///< from the point to the body, negative inside [m]
    Vec3 normal = Vec3::Zero();  ///< out of the body, wall's axes
  };
  AtPoint at_point(const Vec3& x, double reach) const {
    static thread_local ContactSet set;  // keeps its size
    set.clear();
    ContactSink found(set);
    found.begin(0, 1);
    const Pose point{q_.b.to_world(x), Quat(1, 0, 0, 0)};
    guest_.on_point(guest_.shape, {point, q_.a, reach, false}, found);
    found.end();
    AtPoint out;
    for (std::size_t k = 0; k < set.size(); ++k)
      if (set.gap[k] < out.gap) out = {set.gap[k], -(q_.b.orientation.conjugate() * set.normal[k])};
    return out;
  }

  void meet_rim(bool at_end) {
    const double rim = wall_.radius_of_end(at_end), z = wall_.z_of_end(at_end), over = at_.z() - z;
    const double across = radius_ - rim, far = radius_ + rim;
    const double near = size_ + q_.reach;
    if (!(rim > 0.0) || over * over + across * across > near * near) return;
    const auto place = [&](const Vec3& azimuth) { return Vec3(rim * azimuth.x(), rim * azimuth.y(), z); };
    const double reach = q_.reach + 2.0 * size_ + far;  // all of them, so that minima are told from rises
    std::array<double, azimuths> value;
    for (std::size_t k = 0; k < azimuths; ++k) value[k] = at_point(place(directions()[k]), reach).gap;
    const double level = 1e-9 * size_;
    static thread_local std::vector<Point> points;
    points.clear();
    for (std::size_t k = 0; k < azimuths; ++k) {
      const double before = value[(k + azimuths - 1) % azimuths], after = value[(k + 1) % azimuths];
      if (value[k] > before + level || value[k] > after + level) continue;
      if (value[k] - spacing * rim > q_.reach) continue;  // it changes by less in between
      const bool flat = value[k] >= before - level && value[k] >= after - level;
      const auto gap = [&](double u) { return at_point(place(direction_near(k, u)), reach).gap; };
      const double u = flat ? 0.0 : least_between(gap);
      add_rim_point(direction_near(k, u), place, at_end, flat ? Feature{8 + k} : Feature{points.size()}, points);
    }
    sink_.enter_part(at_end ? end_part : start_part, Vec3::Zero());
    keep(points);
    sink_.leave_part(Vec3::Zero());
  }

  /// On an edge of the body the normal is between those of its two faces, perpendicular to the rim.
  template <class Place>
  void add_rim_point(const Vec3& azimuth, const Place& place, bool at_end, Feature feature,
                     std::vector<Point>& points) const {
    const Vec3 along(-azimuth.y(), azimuth.x(), 0.0), x = place(azimuth);
    const double aside = 1e-6, reach = q_.reach + 2.0 * size_;
    const AtPoint here = at_point(x, reach);
    const AtPoint left = at_point(place((azimuth - aside * along).normalized()), reach);
    const AtPoint right = at_point(place((azimuth + aside * along).normalized()), reach);
    const double sl = left.normal.dot(along), sr = right.normal.dot(along);
    Vec3 sum = here.normal;
    double scale = 1.0;
    if (here.gap < 0.0 && sl * sr < 0.0 && std::abs(sl - sr) > 1e-4) {
      const double share = sr / (sr - sl);
      sum = share * left.normal + (1.0 - share) * right.normal;
      scale = 1.0 / sum.norm();
    }
    sum -= sum.dot(along) * along;
    if (!(sum.squaredNorm() > 0.0)) return;
    const Vec3 out = sum.normalized();
    const double gap = scale * here.gap;
    if (!(gap < q_.reach)) return;
    const double outside = -out.dot(side_normal(azimuth)), rim = wall_.radius_of_end(at_end);
    const Point p{x - 0.5 * gap * out, out, gap, outside * wall_.along_z / rim, feature};
    const auto is_there = [&](const Point& o) { return (o.place - p.place).squaredNorm() < near_square(); };
    if (std::ranges::none_of(points, is_there)) points.push_back(p);
  }

  const HollowGuest& guest_;
  const HollowWall& wall_;
  const PairQuery& q_;
  ContactSink& sink_;
  Vec3 at_;        ///< its centre, wall's axes [m]
  Mat3 turn_;      ///< its axes in the wall's
  double radius_;  ///< of its centre [m]
  double size_;
};

}  // namespace

void collide_guest(const HollowGuest& guest, const HollowWall& wall, const PairQuery& q, ContactSink& sink) {
  Guest(guest, wall, q, sink).collide();
}

}  // namespace epafi
