#include "detection/shapes/superquadric.h"

#include <algorithm>
#include <cmath>

namespace epafi {
namespace {

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

/// Point (u, v) of u^n + v^n = 1 where p u + q v is largest; p, q >= 0, not both 0.
struct GridCorner {
  double u, v;
};
GridCorner farthest(double p, double q, int n) {
  const double most = std::max(p, q);
  const double u = whole_root(p / most, n - 1), v = whole_root(q / most, n - 1);
  const double scale = whole_root(whole_power(u, n) + whole_power(v, n), n);
  return {u / scale, v / scale};
}

}  // namespace

double whole_power(double x, int k) {
  double result = 1.0;
  for (; k > 0; k >>= 1, x *= x)
    if (k & 1) result *= x;
  return result;
}

double whole_root(double x, int k) {
  if (!(x > 0.0)) return 0.0;
  if (k == 1 || x == 1.0) return x;
  if (k == 2) return std::sqrt(x);
  int exponent = 0;
  double fraction = std::frexp(x, &exponent);  // exact
  const int shift = ((exponent % k) + k) % k;
  const double t = 1.0 - static_cast<double>(shift) / k;  // the root lies in [2^-t 2^(-1/k), 2^-t)
  fraction = std::ldexp(fraction, shift - k);
  // 2^-t by its series, within 1e-3 on [0, 1]; from within a factor 1.3 seven steps of Newton's method end in rounding
  double y = 1.0 + t * (-0.6931 + t * (0.2402 + t * (-0.0555 + t * 0.0092)));
  for (int step = 0; step < 7; ++step) y -= (y - fraction / whole_power(y, k - 1)) / k;
  return std::ldexp(y, (exponent - shift) / k + 1);
}

Superquadric::Superquadric(const Vec3& abc, int n, int m) : semi_axes(abc), across(n), along(m) {
  const double section = 4.0 * abc.x() * abc.y() * shape_integral(0, n, 1.0 / n);  // area at z = 0
  volume_ = 2.0 * abc.z() * section * shape_integral(0, m, 2.0 / m);
  // a bound may be a little large, never small
  radius_ = (1.0 + 1e-12) * reach_of(reach_of(abc.x(), abc.y(), n), abc.z(), m);
  contact_radius_ = equal_volume_radius(volume_);
  least_radius_ = find_least_radius();
}

/// Of the directions of a grid over one octant, halved for what lies between them.
double Superquadric::find_least_radius() const {
  constexpr int cells = 24;
  double least = infinity;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; i + j <= cells; ++j) {
      const Vec3 d = Vec3(i, j, cells - i - j).cwiseQuotient(semi_axes).normalized();
      const Mat3 k = curved_support(d).derivative;
      // the two radii are the roots of x^2 - trace x + sum of the principal minors
      const double trace = k.trace();
      const double minors = 0.5 * (trace * trace - (k * k).trace());
      const double root = std::sqrt(std::max(0.0, 0.25 * trace * trace - minors));
      least = std::min(least, minors / (0.5 * trace + root));
    }
  return 0.5 * least;
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

Superquadric::UnitPoint Superquadric::unit_point(const Vec3& d) const {
  const Vec3 stretched = semi_axes.cwiseProduct(d).cwiseAbs();
  UnitPoint p;
  if (!(stretched.maxCoeff() > 0.0)) return p;
  if (std::max(stretched.x(), stretched.y()) > 0.0) {
    const GridCorner flat = farthest(stretched.x(), stretched.y(), across);
    p.u = flat.u;
    p.v = flat.v;
    p.beside = stretched.x() * flat.u + stretched.y() * flat.v;
  }
  const GridCorner up = farthest(p.beside, stretched.z(), along);
  p.scale = up.u;
  p.height = up.v;
  p.reach = p.beside * up.u + stretched.z() * up.v;
  return p;
}

Vec3 Superquadric::on_surface(const UnitPoint& p, const Vec3& d) const {
  Vec3 out = semi_axes.cwiseProduct(Vec3(p.u * p.scale, p.v * p.scale, p.height));
  for (int k = 0; k < 3; ++k)
    if (d[k] < 0.0) out[k] = -out[k];
  return out;
}

Vec3 Superquadric::support(const Vec3& d) const { return on_surface(unit_point(d), d); }

CurvedSupport Superquadric::curved_support(const Vec3& d) const {
  const UnitPoint p = unit_point(d);
  const auto flatness = [](double x, int n) { return 1.0 / whole_power(std::max(x, least_side), n - 2); };
  // second derivatives of the norm of (T, z) along z, T that of (x, y) across it: for each of exponent n' dual to n,
  // with gradient g, (diag(g^(2 - n)) - g g^T) / ((n - 1) norm)
  const double h = 1.0 / ((along - 1) * p.reach);
  const double tt = h * (flatness(p.scale, along) - p.scale * p.scale), tz = -h * p.scale * p.height;
  const double zz = h * (flatness(p.height, along) - p.height * p.height);
  const double t = flatness(p.scale, along) / ((across - 1) * p.reach);  // scale / beside, finite at the poles
  Mat3 m;
  m << tt * p.u * p.u + t * (flatness(p.u, across) - p.u * p.u), tt * p.u * p.v - t * p.u * p.v, tz * p.u,  //
      tt * p.u * p.v - t * p.u * p.v, tt * p.v * p.v + t * (flatness(p.v, across) - p.v * p.v), tz * p.v,   //
      tz * p.u, tz * p.v, zz;
  Vec3 signed_axes = semi_axes;
  for (int k = 0; k < 3; ++k)
    if (d[k] < 0.0) signed_axes[k] = -signed_axes[k];
  return {on_surface(p, d), signed_axes.asDiagonal() * m * signed_axes.asDiagonal()};
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
