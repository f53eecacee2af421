#include "detection/narrow/pairs/hertz_radius.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "engine/railway/elliptic_integrals.h"
#include "engine/state/rotation.h"

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

/// R* A, a function of A/B alone.
double radius_times_a(double a_over_b) {
  const EllipticIntegrals i = elliptic_integrals(axis_ratio(a_over_b));
  return std::numbers::pi * std::numbers::pi * i.D / (4.0 * i.K * i.K * i.K);
}

/// The same by Chebyshev series, which take a twentieth of the time of the integrals. One for each of `parts` pieces of
/// every octave of A/B: the function is singular at 0 only, nine half widths from a piece's middle or more, so that
/// series end by 17.9 a term, after `terms` below 1e-15.
class RadiusSeries {
 public:
  static constexpr int octaves = 24, parts = 4, terms = 14;
  static constexpr double least = 1.0 / (1 << octaves);  ///< of A/B

  RadiusSeries() : series_(octaves * parts) {
    for (int k = 0; k < octaves * parts; ++k) series_[static_cast<std::size_t>(k)] = fit(k);
  }
  /// least <= a_over_b < 1.
  double operator()(double a_over_b) const {
    // octave and piece are the exponent and the first two bits of the fraction
    const auto bits = std::bit_cast<std::uint64_t>(a_over_b);
    const auto piece = static_cast<std::size_t>(bits >> 50) - first_piece;
    const double low = std::bit_cast<double>(bits >> 50 << 50);
    const double width = std::bit_cast<double>(bits >> 52 << 52) / parts;
    const double x = 2.0 * (a_over_b - low) / width - 1.0, twice = 2.0 * x;
    const std::array<double, terms>& c = series_[piece];
    double b = 0.0, before = 0.0;  // Clenshaw 1955
    for (std::size_t n = terms - 1; n > 0; --n) {
      const double next = c[n] + twice * b - before;
      before = b;
      b = next;
    }
    return c[0] + x * b - before;
  }

 private:
  static constexpr std::size_t first_piece = (1023 - octaves) * parts;

  /// By the values at the zeros of the next polynomial.
  static std::array<double, terms> fit(int piece) {
    const double octave = std::ldexp(1.0, piece / parts - octaves), width = octave / parts;
    const double middle = octave + (piece % parts + 0.5) * width;
    std::array<double, terms> c{};
    for (int j = 0; j < terms; ++j) {
      const double angle = std::numbers::pi * (j + 0.5) / terms;
      const double value = radius_times_a(middle + 0.5 * width * sin_cos(angle).cos);
      for (int n = 0; n < terms; ++n)
        c[static_cast<std::size_t>(n)] += (n == 0 ? 1.0 : 2.0) / terms * value * sin_cos(n * angle).cos;
    }
    return c;
  }
  std::vector<std::array<double, terms>> series_;
};

/// derivative(): asked where the curvature counts. u, v: across the normal.
template <class Derivative>
CurvatureAcross curvature_of(const RoundRef& shape, const Derivative& derivative, const Vec3& u, const Vec3& v,
                             double swept) {
  if (shape.curved) return {derivative(), u, v, swept};
  CurvatureAcross sphere;
  sphere.uu = sphere.vv = 1.0 / shape.contact_radius;
  return sphere;
}

/// R* (A + B) as a series of e^2 = ((B - A)/(A + B))^2, of the relations in hertz_radius.h: 1e-14 up to e = 1/4.
double nearly_round_hertz(double e2) {
  constexpr std::array<double, 11> factor{1.0,
                                          2.0 / 3.0,
                                          31.0 / 54.0,
                                          0.52469135802469136,
                                          0.49232681755829904,
                                          0.46879604226997917,
                                          0.45057856257797197,
                                          0.43586701357723623,
                                          0.42362136817196632,
                                          0.4131931840818744,
                                          0.40415332774583317};
  double sum = 0.0;
  for (std::size_t k = factor.size(); k-- > 0;) sum = sum * e2 + factor[k];
  return sum;
}

}  // namespace

double hertz_radius(double A, double B) {
  if (!(A > 0.0)) return infinity;
  static const RadiusSeries series;
  const double ratio = A / B;
  if (!(ratio < 1.0)) return 0.5 / A;
  return (ratio >= RadiusSeries::least ? series(ratio) : radius_times_a(ratio)) / A;
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
  const auto on_a = [&]() -> Mat3 { return a.curved_support_of(a.shape, n).derivative; };
  const auto on_b = [&]() -> Mat3 {
    const Mat3 in_b = b.curved_support_of(b.shape, -(rotation.transpose() * n)).derivative;
    return rotation * in_b * rotation.transpose();
  };
  return hertz_radius(curvature_of(a, on_a, u, v, swept_a), curvature_of(b, on_b, u, v, swept_b));
}

double hertz_radius_on_plane(const RoundRef& a, double swept, const Vec3& d) {
  const auto [u, v] = Tangents(d);
  const auto on_a = [&]() -> Mat3 { return a.curved_support_of(a.shape, d).derivative; };
  return hertz_radius(curvature_of(a, on_a, u, v, swept), {});
}

double wall_contact_radius(double r, double curvature) {
  const double least = std::max(curvature, -0.9 / r);
  const double sum = 1.0 / r + 0.5 * least, e = 0.5 * std::abs(least) / sum;
  if (e <= 0.25) return nearly_round_hertz(e * e) / sum;
  const double along = 0.5 / r, across = 0.5 * (1.0 / r + least);
  return hertz_radius(std::min(along, across), std::max(along, across));
}

}  // namespace epafi
