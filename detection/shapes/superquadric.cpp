#include "detection/shapes/superquadric.h"

#include <algorithm>
#include <cmath>

#include "detection/shapes/whole_root.h"

namespace epafi {
namespace {

using TwoRoots = LanesOf<2>::Real;

/// Integral over w in [0, 1] of w^p (1 - w^n)^q.
double shape_integral(double p, double n, double q) {
  return std::exp(std::lgamma((p + 1) / n) + std::lgamma(q + 1) - std::lgamma((p + 1) / n + q + 1)) / n;
}

/// Largest distance from the centre of (|x/a|^n + |y/b|^n <= 1): Hoelder's inequality.
double reach_of(double a, double b, int n) {
  if (n == 2) return std::max(a, b);
  const double k = 2.0 * n / (n - 2.0), most = std::max(a, b);
  return most * std::sqrt(std::pow(std::pow(a / most, k) + std::pow(b / most, k), 1.0 - 2.0 / n));
}

}  // namespace

Superquadric::Superquadric(const Vec3& abc, int n, int m) : semi_axes(abc), across(n), along(m) {
  const double section = 4.0 * abc.x() * abc.y() * shape_integral(0, n, 1.0 / n);  // area at z = 0
  volume_ = 2.0 * abc.z() * section * shape_integral(0, m, 2.0 / m);
  // a bound may be a little large, never small
  radius_ = (1.0 + 1e-12) * reach_of(reach_of(abc.x(), abc.y(), n), abc.z(), m);
  contact_radius_ = equal_volume_radius(volume_);
  least_radius_ = find_least_radius();
}

/// The smaller principal radius where the normal is d [m].
double Superquadric::radius_at(const Vec3& d) const {
  const Mat3 k = curved_support(d).derivative;
  const Vec3 u = d.unitOrthogonal(), v = d.cross(u);
  const Vec3 ku = k * u, kv = k * v;
  const double uu = u.dot(ku), uv = u.dot(kv), vv = v.dot(kv);
  const double mean = 0.5 * (uu + vv), apart = 0.5 * (uu - vv);
  return (uu * vv - uv * uv) / (mean + std::sqrt(apart * apart + uv * uv));
}

/// The least of a grid of directions over one octant, and from there downhill by ever shorter steps along the grid.
double Superquadric::find_least_radius() const {
  constexpr int cells = 24;
  const auto radius = [this](const Vec3& sides) { return radius_at(sides.cwiseQuotient(semi_axes).normalized()); };
  double least = infinity;
  Vec3 best;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; i + j <= cells; ++j) {
      const Vec3 sides(i, j, cells - i - j);
      const double r = radius(sides);
      if (!(r < least)) continue;
      least = r;
      best = sides;
    }
  double step = 0.5;
  for (int round = 0; round < 60 && step > 1e-3; ++round) {
    const Vec3 from = best;
    for (int axis = 0; axis < 6; ++axis) {
      Vec3 to = from;
      to[axis / 2] += axis % 2 == 0 ? step : -step;
      const double r = radius(to.cwiseAbs());
      if (!(r < least)) continue;
      least = r;
      best = to.cwiseAbs();
    }
    if (best == from) step *= 0.5;
  }
  return 0.98 * least;
}

Entry Superquadric::entry() {
  constexpr Range exponent{2, 32, false, false};
  return {name,
          "superquadric about its centre, from ellipsoid to rounded box",
          {{"semi_axes", "a b c", "m", Kind::vec3, {}, positive, "half lengths along x, y and z"},
           {"across", "n", "", Kind::integer, {}, exponent, "exponent across the z axis; 2: round, large: square"},
           {"along", "m", "", Kind::integer, {}, exponent, "exponent along the z axis; 2: round, large: flat ends"}},
          {},
          "Barr 1981"};
}

// The norm dual to that of exponent n is T = (p^n' + q^n')^(1/n'), n' = n/(n - 1). With p^n' = p p^(1/(n - 1)) that is
// S^(1 - 1/n) of S = p p^(1/(n - 1)) + q q^(1/(n - 1)), and the coordinates are p^(1/(n - 1)) S^(-1/n).
Superquadric::UnitPoint Superquadric::unit_point(const Vec3& d) const {
  const Vec3 stretched = semi_axes.cwiseProduct(d).cwiseAbs();
  const double most = stretched.maxCoeff();
  if (!(most > 0.0)) return {};
  const Vec3 sides = stretched / most;
  UnitPoint p = across == along ? point_of_one_exponent(sides) : point_of_two_exponents(sides);
  p.reach *= most;
  return p;
}

Superquadric::UnitPoint Superquadric::point_of_one_exponent(const Vec3& sides) const {
  const Lanes roots = whole_roots(Lanes{sides.x(), sides.y(), sides.z(), 0.0}, along - 1);
  const Vec3 root(roots[0], roots[1], roots[2]);
  const double sum = sides.dot(root), of_sum = whole_root(sum, along), norm = sum / of_sum;
  UnitPoint p;
  p.x = root / of_sum;
  p.slope = sides / norm;
  p.reach = norm;
  return p;
}

Superquadric::UnitPoint Superquadric::point_of_two_exponents(const Vec3& sides) const {
  UnitPoint p;
  double beside = 0.0;  // norm of the sides along x and y
  if (std::max(sides.x(), sides.y()) > 0.0) {
    const TwoRoots roots = whole_roots(TwoRoots{sides.x(), sides.y()}, across - 1);
    const double sum = sides.x() * roots[0] + sides.y() * roots[1], of_sum = whole_root(sum, across);
    beside = sum / of_sum;
    p.section = {roots[0] / of_sum, roots[1] / of_sum};
    p.section_slope = {sides.x() / beside, sides.y() / beside};
  }
  const TwoRoots roots = whole_roots(TwoRoots{beside, sides.z()}, along - 1);
  const double sum = beside * roots[0] + sides.z() * roots[1], of_sum = whole_root(sum, along), norm = sum / of_sum;
  p.scale = roots[0] / of_sum;
  p.scale_slope = beside / norm;
  p.x = {p.section[0] * p.scale, p.section[1] * p.scale, roots[1] / of_sum};
  p.slope.z() = sides.z() / norm;
  p.reach = norm;
  return p;
}

Vec3 Superquadric::signed_axes(const Vec3& d) const {
  Vec3 out = semi_axes;
  for (int k = 0; k < 3; ++k)
    if (d[k] < 0.0) out[k] = -out[k];
  return out;
}

Vec3 Superquadric::support(const Vec3& d) const { return signed_axes(d).cwiseProduct(unit_point(d).x); }

/// x^(2 - n), where slope = x^(n - 1).
double Superquadric::flatness(double x, double slope, int n) {
  if (n == 2) return 1.0;
  return x < flattest * slope ? x / slope : flattest;
}

// The second derivatives of a norm dual to exponent n, with gradient x: (diag(x^(2 - n)) - x x^T) / ((n - 1) norm).
Mat3 Superquadric::curvature(const UnitPoint& p) const {
  const double h = 1.0 / ((along - 1) * p.reach);
  const double zz = flatness(p.x.z(), p.slope.z(), along);
  if (across == along) {
    Mat3 m = (-h * p.x) * p.x.transpose();
    m(0, 0) += h * flatness(p.x.x(), p.slope.x(), along);
    m(1, 1) += h * flatness(p.x.y(), p.slope.y(), along);
    m(2, 2) += h * zz;
    return m;
  }
  // of the norm of (T, z) along z, T that of (x, y) across it
  const double of_scale = flatness(p.scale, p.scale_slope, along), u = p.section[0], v = p.section[1];
  const double tt = h * (of_scale - p.scale * p.scale), tz = -h * p.scale * p.x.z();
  const double t = of_scale / ((across - 1) * p.reach);  // scale / T, finite at the poles
  const double uu = t * (flatness(u, p.section_slope[0], across) - u * u);
  const double vv = t * (flatness(v, p.section_slope[1], across) - v * v);
  Mat3 m;
  m << tt * u * u + uu, (tt - t) * u * v, tz * u,  //
      (tt - t) * u * v, tt * v * v + vv, tz * v,   //
      tz * u, tz * v, h * (zz - p.x.z() * p.x.z());
  return m;
}

CurvedSupport Superquadric::curved_support(const Vec3& d) const {
  const UnitPoint p = unit_point(d);
  const Vec3 axes = signed_axes(d);
  return {axes.cwiseProduct(p.x), axes.asDiagonal() * curvature(p) * axes.asDiagonal()};
}

Vec3 Superquadric::gradient(const Vec3& x) const {
  const Vec3 size = x.cwiseAbs();
  double of_section = 1.0;
  if (across != along) {
    const double radius = whole_root(whole_power(size.x(), across) + whole_power(size.y(), across), across);
    of_section = along > across ? whole_power(radius, along - across)
                                : 1.0 / whole_power(std::max(radius, 1e-6), across - along);
  }
  const Vec3 g(of_section * whole_power(size.x(), across - 1), of_section * whole_power(size.y(), across - 1),
               whole_power(size.z(), along - 1));
  return {x.x() < 0.0 ? -g.x() : g.x(), x.y() < 0.0 ? -g.y() : g.y(), x.z() < 0.0 ? -g.z() : g.z()};
}

Vec3 Superquadric::turned(const Vec3& d, const CurvedSupport& at, const Vec3& step) const {
  const Vec3 axes = signed_axes(d);
  const Vec3 sides = axes.cwiseProduct(d), change = axes.cwiseProduct(step);
  const Vec3 x = at.point.cwiseQuotient(axes), next = x + (at.derivative * step).cwiseQuotient(axes);
  // of the new normal, to first order that of sides + change and never below 0
  const double size = x.dot(sides), growth = x.dot(change) / size;
  const double length = growth < 0.0 ? size / (1.0 - growth) : size * (1.0 + growth);
  const Vec3 by_point = length * gradient(next.cwiseMax(-1.0).cwiseMin(1.0));
  Vec3 out;
  for (int k = 0; k < 3; ++k) out[k] = (change[k] > 0.0 ? sides[k] + change[k] : by_point[k]) / axes[k];
  return out.normalized();
}

Aabb Superquadric::bounding_box(const Pose& pose) const {
  const Mat3 rotation = pose.orientation.toRotationMatrix();
  Vec3 half;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 d = rotation.row(axis).transpose();
    half[axis] = d.dot(support(d));
  }
  return {pose.position - half, pose.position + half};
}

MassProperties Superquadric::mass_properties() const {
  const double a = semi_axes.x(), b = semi_axes.y(), c = semi_axes.z(), n = across, m = along;
  // sections at height z are scaled by s, s^m + (z/c)^m = 1
  const double section = 4.0 * a * b * shape_integral(0, n, 1.0 / n),
               second = 4.0 * a * b * shape_integral(2, n, 1.0 / n);
  const double fourth = 2.0 * c * shape_integral(0, m, 4.0 / m);
  const double xx = a * a * second * fourth, yy = b * b * second * fourth;
  const double zz = 2.0 * c * c * c * section * shape_integral(2, m, 2.0 / m);
  return {volume_, Vec3::Zero(), Vec3(yy + zz, xx + zz, xx + yy).asDiagonal()};
}

}  // namespace epafi
