#include "detection/narrow/pairs/hertz_radius.h"

#include <cmath>
#include <numbers>

#include "engine/railway/elliptic_integrals.h"

namespace epafi {
namespace {

/// k of A/B = k^2 D/B: k <- sqrt(A/B * B/D) gains a factor of four a round, Aitken's extrapolation the rest.
double axis_ratio(double a_over_b) {
  const auto round = [&](double k) {
    const EllipticIntegrals i = elliptic_integrals(k);
    return std::min(1.0, std::sqrt(a_over_b * i.B / i.D));
  };
  double k = std::sqrt(a_over_b);
  for (int n = 0; n < 20; ++n) {
    const double first = round(k), second = round(first);
    const double bend = (second - first) - (first - k);
    const double next = std::abs(bend) > 1e-15 ? k - (first - k) * (first - k) / bend : second;
    const double better = next > 0.0 && next <= 1.0 ? next : second;
    if (std::abs(better - k) <= 1e-12 * k) return better;
    k = better;
  }
  return k;
}

CurvatureAcross curvature_of(const RoundRef& shape, const Mat3& derivative, const Vec3& u, const Vec3& v,
                             double swept) {
  if (shape.curved) return {derivative, u, v, swept};
  CurvatureAcross sphere;
  sphere.uu = sphere.vv = 1.0 / shape.contact_radius;
  return sphere;
}

}  // namespace

double hertz_radius(double A, double B) {
  if (!(A > 0.0)) return infinity;
  const double k = axis_ratio(std::min(1.0, A / B));
  const EllipticIntegrals i = elliptic_integrals(k);
  return std::numbers::pi * std::numbers::pi * i.D / (4.0 * i.K * i.K * i.K * A);
}

CurvatureAcross::CurvatureAcross(const Mat3& derivative, const Vec3& u, const Vec3& v, double swept) {
  const Vec3 ku = derivative * u, kv = derivative * v;
  const double radius_uu = u.dot(ku) + swept, radius_uv = u.dot(kv), radius_vv = v.dot(kv) + swept;
  const double determinant = radius_uu * radius_vv - radius_uv * radius_uv;
  uu = radius_vv / determinant;
  uv = -radius_uv / determinant;
  vv = radius_uu / determinant;
}

double hertz_radius(const CurvatureAcross& a, const CurvatureAcross& b) {
  const double uu = a.uu + b.uu, uv = a.uv + b.uv, vv = a.vv + b.vv;
  const double mean = 0.5 * (uu + vv);
  const double apart = std::sqrt(0.25 * (uu - vv) * (uu - vv) + uv * uv);
  return hertz_radius(0.5 * (mean - apart), 0.5 * (mean + apart));
}

double hertz_radius(const RoundRef& a, double swept_a, const RoundRef& b, double swept_b, const Mat3& rotation,
                    const Vec3& n) {
  const auto [u, v] = Tangents(n);
  const Mat3 on_a = a.curved_support_of(a.shape, n).derivative;
  const Mat3 on_b = b.curved_support_of(b.shape, -(rotation.transpose() * n)).derivative;
  return hertz_radius(curvature_of(a, on_a, u, v, swept_a),
                      curvature_of(b, rotation * on_b * rotation.transpose(), u, v, swept_b));
}

double hertz_radius_on_plane(const RoundRef& a, double swept, const Vec3& d) {
  const auto [u, v] = Tangents(d);
  return hertz_radius(curvature_of(a, a.curved_support_of(a.shape, d).derivative, u, v, swept), {});
}

}  // namespace epafi
