#include "engine/state/rotation.h"

#include <cmath>

namespace epafi {

namespace {
/// Of |r| <= pi/4.
SinCos sin_cos_near_zero(double r) {
  const double z = r * r;
  if (z < 1e-16) return {r, 1.0};  // what the series gives: all terms behind the first are lost in rounding
  // Taylor series: at |r| <= pi/4 the first term left out is below 1e-18
  double s = 0.0, c = 0.0;
  constexpr std::array<double, 8> odd{1.0,          -1.0 / 6,        1.0 / 120,          -1.0 / 5040,
                                      1.0 / 362880, -1.0 / 39916800, 1.0 / 6227020800.0, -1.0 / 1307674368000.0};
  constexpr std::array<double, 9> even{1.0,
                                       -1.0 / 2,
                                       1.0 / 24,
                                       -1.0 / 720,
                                       1.0 / 40320,
                                       -1.0 / 3628800,
                                       1.0 / 479001600.0,
                                       -1.0 / 87178291200.0,
                                       1.0 / 20922789888000.0};
  for (std::size_t i = odd.size(); i-- > 0;) s = s * z + odd[i];
  for (std::size_t i = even.size(); i-- > 0;) c = c * z + even[i];
  return {s * r, c};
}
}  // namespace

SinCos sin_cos(double x) {
  if (std::abs(x) < 0.75) return sin_cos_near_zero(x);  // to which the reduction would take nothing off
  // pi/2 in two parts, the first exact times small integers (Cody and Waite 1980)
  constexpr double two_over_pi = 0.63661977236758138, high = 1.57079632673412561417e+00,
                   low = 6.07710050650619224932e-11;
  const double k = std::nearbyint(x * two_over_pi);
  const auto [s, c] = sin_cos_near_zero((x - k * high) - k * low);
  const auto quadrant = static_cast<long long>(k) & 3;
  if (quadrant == 0) return {s, c};
  if (quadrant == 1) return {c, -s};
  if (quadrant == 2) return {-s, -c};
  return {-c, s};
}

namespace {

/// Rotates about body axis k by `angle`: q <- q * exp(e_k angle/2); the momentum in body axes rotates the other way.
void turn_about_axis(Quat& q, Vec3& momentum, int k, double angle) {
  if (angle == 0.0) return;  // of a body with two equal moments in two turns of three
  const SinCos half = sin_cos(0.5 * angle);
  Quat step(half.cos, 0, 0, 0);
  step.vec()[k] = half.sin;
  q = q * step;
  const double c = half.cos * half.cos - half.sin * half.sin, s = 2.0 * half.sin * half.cos;
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const double mi = momentum[i], mj = momentum[j];
  momentum[i] = c * mi + s * mj;
  momentum[j] = c * mj - s * mi;
}

}  // namespace

Quat turned_far(const Quat& q, const Vec3& angle) {
  const double square = angle.squaredNorm();
  const double a = std::sqrt(square);
  const SinCos half = sin_cos(0.5 * a);
  Quat step;
  step.w() = half.cos;
  step.vec() = angle * (half.sin / a);
  return (step * q).normalized();
}

/// Flattened: Eigen's products stay calls otherwise.
[[gnu::flatten]] void rotate_freely(Quat& q, const Vec3& angular_momentum, const Vec3& inverse_inertia, double dt) {
  // H = |L|^2 v_mid / 2 + sum_k L_k^2 (v_k - v_mid) / 2: the first part turns the body about L in space and commutes
  // with the rest
  const Vec3& v = inverse_inertia;
  int low = 0, high = 0;
  for (int k = 1; k < 3; ++k) {
    if (v[k] < v[low]) low = k;
    if (v[k] >= v[high]) high = k;
  }
  const int mid = low == high ? 1 : 3 - low - high;
  Vec3 body = q.conjugate() * angular_momentum;
  turn_about_axis(q, body, low, 0.5 * dt * (v[low] - v[mid]) * body[low]);
  turn_about_axis(q, body, high, dt * (v[high] - v[mid]) * body[high]);
  turn_about_axis(q, body, low, 0.5 * dt * (v[low] - v[mid]) * body[low]);
  q = turned(q, angular_momentum * (v[mid] * dt));
}

}  // namespace epafi
