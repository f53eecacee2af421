// Boundary elements on half-spaces against exact solutions (Hertz, Cattaneo, Carter's limit) and against their own
// refinement.
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "engine/units/random.h"
#include "laws/wheel_rail/half_space/normal.h"
#include "laws/wheel_rail/half_space/tangential.h"
#include "laws/wheel_rail/normal/hertz_ellipse.h"
#include "laws/wheel_rail/tangential/kalker_linear.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

using std::numbers::pi;
const ElasticPair half_spaces{210e9 / 2.6, 0.3, 0.0};

std::vector<double> quadratic(const PatchGrid& g, double A, double B) {
  std::vector<double> gap(g.size());
  for (std::size_t k = 0; k < gap.size(); ++k)
    gap[k] = A * g.x(k % g.nx) * g.x(k % g.nx) + B * g.y(k / g.nx) * g.y(k / g.nx);
  return gap;
}

/// The published ellipse: a = 8 mm, b = 4 mm, N = 82 kN, mu = 0.3, G = 82 GPa, nu = 0.28.
const Ellipse ellipse{8e-3, 4e-3};
const ElasticPair rail_steel{82e9, 0.28, 0.0};
constexpr double load = 82e3, mu = 0.3;

}  // namespace

TEST_CASE("the transform of eight lines is the sum of its definition", "[laws][wheel_rail]") {
  for (const std::size_t n : {1u, 2u, 3u, 4u, 6u, 8u, 9u, 12u, 18u, 32u, 36u, 48u, 72u}) {
    const Fft fft(n);
    std::vector<double> work(fft.scratch_size());
    std::vector<std::complex<double>> in(n);
    for (std::size_t k = 0; k < n; ++k)
      in[k] = {std::sin(1.0 + 7.0 * static_cast<double>(k)), std::cos(3.0 * static_cast<double>(k * k))};
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t l = 0; l < Fft::lanes; ++l) {
        work[k * 8 + l] = in[k].real() + static_cast<double>(l);
        work[(n + k) * 8 + l] = in[k].imag();
      }
    const double* out = work.data() + fft.transform(work.data(), false);
    for (std::size_t m = 0; m < n; ++m) {
      std::complex<double> sum = 0.0;
      for (std::size_t k = 0; k < n; ++k)
        sum += (in[k] + 3.0) * std::polar(1.0, -2.0 * pi * static_cast<double>(k * m % n) / static_cast<double>(n));
      CHECK(out[m * 8 + 3] == Approx(sum.real()).margin(1e-12 * static_cast<double>(n)));
      CHECK(out[(n + m) * 8 + 3] == Approx(sum.imag()).margin(1e-12 * static_cast<double>(n)));
    }
  }
  CHECK(fft_size(65) == 72);
  CHECK(fft_size(1112) == 1152);
}

TEST_CASE("convolutions by transform equal the plain double sum", "[laws][wheel_rail]") {
  const PatchGrid g{7, 5, 1.1e-3, 0.7e-3};
  std::vector<double> p(g.size()), u(g.size());
  TangentialField q(g.size()), v(g.size());
  for (std::size_t k = 0; k < p.size(); ++k) {
    p[k] = std::sin(1.0 + 5.0 * static_cast<double>(k));
    q.x[k] = std::cos(2.0 * static_cast<double>(k));
    q.y[k] = p[k] * p[k];
  }
  PressureKernel normal(g, half_spaces);
  normal.apply(p, u);
  TractionKernel difference(g, half_spaces, KernelKind::difference);
  difference.apply(q, v);
  for (std::size_t i = 0; i < p.size(); ++i) {
    double uz = 0.0, ux = 0.0, uy = 0.0;
    for (std::size_t j = 0; j < p.size(); ++j) {
      const double x = g.x(i % 7) - g.x(j % 7), y = g.y(i / 7) - g.y(j / 7);
      const Influence k = influence(x, y, 0.5 * g.dx, 0.5 * g.dy, half_spaces),
                      n = influence(x + g.dx, y, 0.5 * g.dx, 0.5 * g.dy, half_spaces);
      uz += k.zz * p[j];
      ux += (k.xx - n.xx) * q.x[j] + (k.xy - n.xy) * q.y[j];
      uy += (k.xy - n.xy) * q.x[j] + (k.yy - n.yy) * q.y[j];
    }
    const double size = 1e-12 * normal.self() * 10.0;
    CHECK(u[i] == Approx(uz).margin(size));
    CHECK(v.x[i] == Approx(ux).margin(size));
    CHECK(v.y[i] == Approx(uy).margin(size));
  }
}

TEST_CASE("the influence of a far rectangle is that of a point force", "[laws][wheel_rail]") {
  // Boussinesq and Cerruti: u_z = (1 - nu) P / (pi G r), u_x = P/(pi G r) ((1 - nu) + nu x^2/r^2)  for two bodies
  const double x = 0.3, y = -0.2, r = std::hypot(x, y), P = 4e-6, s = P / (pi * half_spaces.shear_modulus * r),
               nu = half_spaces.poissons_ratio;
  const Influence k = influence(x, y, 1e-3, 1e-3, half_spaces);
  CHECK(k.zz == Approx(s * (1.0 - nu)).epsilon(1e-5));
  CHECK(k.xx == Approx(s * (1.0 - nu + nu * x * x / r / r)).epsilon(1e-5));
  CHECK(k.xy == Approx(s * nu * x * y / r / r).epsilon(1e-5));
}

TEST_CASE("normal contact on 32 by 32 cells is Hertz to 1e-3 in pressure and approach, of second order",
          "[laws][wheel_rail]") {
  const double A = 0.5 / 0.46, B = 0.5 / 0.3;
  const HertzContact h = hertz_of_force(A, B, half_spaces.effective_modulus(), 80e3);
  double last = 0.0;
  for (const std::size_t n : {16u, 32u, 64u}) {
    const PatchGrid g{n, n, 2.2 * h.ellipse.a / static_cast<double>(n), 2.2 * h.ellipse.b / static_cast<double>(n)};
    const HalfSpaceNormal s = solve_half_space_normal(g, quadratic(g, A, B), half_spaces, {true, 80e3});
    const double error =
        std::max(std::abs(s.max_pressure / h.max_pressure - 1.0), std::abs(s.approach / h.approach - 1.0));
    CHECK(s.report.converged);
    CHECK(s.normal_force == Approx(80e3).epsilon(1e-12));
    if (n >= 32) {
      CHECK(error < 1e-3);
      CHECK(error < 0.5 * last);
      const HalfSpaceNormal by_approach =
          solve_half_space_normal(g, quadratic(g, A, B), half_spaces, {false, s.approach});
      CHECK(by_approach.normal_force == Approx(80e3).epsilon(1e-5));
    }
    last = error;
  }
}

namespace {

/// Pressures of two regions, each loaded by the gap that a share of the other's pressures has opened, to and fro.
std::vector<double> alternating(const PatchGrid& g, const std::array<std::vector<double>, 2>& gaps, double share,
                                const NormalTarget& target) {
  PressureKernel kernel(g, half_spaces);
  std::vector<double> u(g.size()), p(g.size(), 0.0), one(g.size()), seen(g.size());
  for (int round = 0; round < 30; ++round) {
    const std::vector<double> before = p;
    for (const bool upper : {false, true}) {
      for (std::size_t k = 0; k < p.size(); ++k) one[k] = (g.y(k / g.nx) > 0.0) != upper ? share * before[k] : 0.0;
      kernel.apply(one, u);
      for (std::size_t k = 0; k < p.size(); ++k) seen[k] = gaps[upper ? 1 : 0][k] + u[k];
      const auto s = solve_half_space_normal(g, seen, half_spaces, target, 1e-10);
      for (std::size_t k = 0; k < p.size(); ++k)
        if ((g.y(k / g.nx) > 0.0) == upper) p[k] = s.pressure[k];
    }
  }
  return p;
}

}  // namespace

TEST_CASE("regions apart press on each other with the share of their distance", "[laws][wheel_rail][long]") {
  // two balls side by side on one plane, 10 mm apart, the second 4 um behind the first
  const PatchGrid g{48, 112, 0.2e-3, 0.2e-3};
  const auto ball = [&](std::size_t k, double y, double behind) {
    const double dx = g.x(k % g.nx), dy = g.y(k / g.nx) - y;
    return (dx * dx + dy * dy) / 0.6 + behind;
  };
  std::vector<double> gap(g.size()), first(g.size()), second(g.size());
  for (std::size_t k = 0; k < gap.size(); ++k) {
    first[k] = ball(k, -5e-3, 0.0);
    second[k] = ball(k, 5e-3, 4e-6);
    gap[k] = std::min(first[k], second[k]);
    (g.y(k / g.nx) < 0.0 ? second : first)[k] = 1.0;
  }
  GapProfile line{g.y(0), g.dy, {}, {}, {}};
  for (std::size_t j = 0; j < g.ny; ++j) line.gap.push_back(std::min(gap[j * g.nx + 23], gap[j * g.nx + 24]));
  const double approach = 20e-6;
  const std::vector<OverlapRange> overlaps = overlaps_of(line, approach);
  REQUIRE(overlaps.size() == 2);
  const double apart = overlaps[1].low - overlaps[0].high;
  CHECK(apart == Approx(10e-3 - std::sqrt(0.6 * 20e-6) - std::sqrt(0.6 * 16e-6)).margin(1e-5));
  const NormalTarget target{false, approach};
  const auto solve = [&](const InfluenceRange& range) {
    return solve_half_space_normal(g, gap, half_spaces, target, 1e-9, Separation(overlaps, range));
  };
  // nearer than `full`: one half-space; farther than `none`: each for itself
  const auto whole = solve_half_space_normal(g, gap, half_spaces, target, 1e-9), near = solve({apart + 1e-6, 1.0});
  CHECK(near.normal_force == whole.normal_force);
  const double alone = solve_half_space_normal(g, first, half_spaces, target, 1e-9).normal_force +
                       solve_half_space_normal(g, second, half_spaces, target, 1e-9).normal_force;
  CHECK(solve({0.0, 0.5 * apart}).normal_force == Approx(alone).epsilon(1e-7));
  CHECK(alone > 1.02 * whole.normal_force);
  // between: the share as a gap that the other region's pressures have closed, to and fro
  const InfluenceRange range{0.5 * apart, 1.5 * apart};
  const HalfSpaceNormal part = solve(range);
  const std::vector<double> p = alternating(g, {first, second}, std::pow(0.5, 0.8), target);
  double difference = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    difference += std::abs(p[k] - part.pressure[k]);
    sum += p[k];
  }
  CHECK(difference < 1e-6 * sum);
  CHECK(part.normal_force < alone);
  CHECK(part.normal_force > whole.normal_force);
}

TEST_CASE("shifted bodies stick inside Cattaneo's circle", "[laws][wheel_rail]") {
  // c/a = (1 - Q/(mu N))^(1/3), shift = 3 mu N (2 - nu) / (8 G a) (1 - (1 - Q/(mu N))^(2/3)) for two like spheres.
  // Exact for nu = 0. Otherwise displacements turn out of the line of the shift and the ring's slip is not opposite to
  // its traction, which Cattaneo leaves out: the force then converges to 1.0012 of his (32, 64, 128 cells across for
  // Q = 0.875 mu N and nu = 0.42: 1.0015, 1.0013, 1.0012; nu = 0: 1.0003, 1.0001, 1.0000).
  const double R = 0.05, force = 9.1954, friction = 0.4;
  for (const double nu : {0.0, 0.42}) {
    const ElasticPair pair{200e6, nu, 0.0};
    const HertzContact h = hertz_of_force(0.5 / R, 0.5 / R, pair.effective_modulus(), force);
    if (nu > 0.0) CHECK(h.ellipse.a == Approx(0.9999999167e-3).epsilon(1e-8));
    const BoundLevels levels = bound_of_ellipse(h.ellipse, force, friction, 64, 64);
    for (const double share : {0.1, 0.5, 0.875, 0.99}) {
      const double ratio = std::cbrt(1.0 - share);
      const double shift =
          3.0 * friction * force * (2.0 - nu) / (8.0 * pair.shear_modulus * h.ellipse.a) * (1.0 - ratio * ratio);
      if (nu > 0.0 && share == 0.5)
        CHECK(shift == Approx(0.004032153608e-3).epsilon(1e-6));  // an independent calculation
      const HalfSpaceTangential s = solve_shift(levels, pair, -shift, 0.0, 0.0);
      CHECK(s.report.converged);
      CHECK(s.force.fx / (friction * force) == Approx(share).epsilon(nu == 0.0 ? 1e-3 : 1.5e-3));
      CHECK(std::sqrt(s.stick_share) == Approx(ratio).margin(0.02));
    }
  }
}

TEST_CASE("steady rolling on the 8 by 4 ellipse comes within 1 % of its limits", "[laws][wheel_rail]") {
  // limits of fine grids (176 x 176, extrapolated, perf/wheel_rail.cpp): 0.4646, 0.6252, 0.6436; published: 0.464,
  // 0.626, 0.643
  const BoundLevels levels = bound_of_ellipse(ellipse, load, mu, 64, 32);
  const auto longitudinal = solve_extrapolated(levels, rail_steel, {-0.001, 0.0, 0.0});
  CHECK(longitudinal.force.fx / (mu * load) == Approx(0.4646).epsilon(0.01));
  CHECK(std::abs(longitudinal.force.fy) < 1e-4 * mu * load);
  const auto with_spin = solve_extrapolated(levels, rail_steel, {0.0, -0.000625, 0.625});
  CHECK(with_spin.force.fy / (mu * load) == Approx(-0.6252).epsilon(0.01));
  const auto spin = solve_extrapolated(levels, rail_steel, {0.0, 0.0, 1.0});
  CHECK(spin.force.fy / (mu * load) == Approx(-0.6436).epsilon(0.01));
  for (const auto* s : {&longitudinal, &with_spin, &spin}) {
    CHECK(s->fine.report.converged);
    CHECK(s->error_estimate < 0.01);
    for (std::size_t k = 0; k < levels.back().bound.size(); ++k)
      CHECK(std::hypot(s->fine.traction.x[k], s->fine.traction.y[k]) <= levels.back().bound[k] * (1.0 + 1e-12));
  }
}

TEST_CASE("small creepages have Kalker's coefficients", "[laws][wheel_rail]") {
  for (const Ellipse e : {Ellipse{4e-3, 8e-3}, Ellipse{5e-3, 5e-3}, Ellipse{8e-3, 4e-3}}) {
    const RollingCase c{e, load, rail_steel, mu, {-2e-6, 0.0, 0.0}};
    const BoundLevels levels = bound_of_ellipse(e, load, mu, 32, 32);
    const double linear = kalker_linear(c).fx;
    CHECK(solve_extrapolated(levels, rail_steel, c.creepage).force.fx ==
          Approx(linear).epsilon(0.025));  // table: three digits; slip at the edge
  }
}

TEST_CASE("the stated error of boundary elements holds their distance to Kalker's spin", "[laws][wheel_rail]") {
  // on the default cells; 80 times more than stated at a/b = 0.8 where two grids agreed by chance
  const std::pair<double, std::size_t> cases[] = {{0.5, 64}, {0.6, 52}, {0.7, 48}, {0.8, 40}, {0.9, 36}, {1.0, 32}};
  for (const auto& [ratio, across] : cases) {
    const Ellipse e{5e-3 * std::sqrt(ratio), 5e-3 / std::sqrt(ratio)};
    const RollingCase c{e, load, rail_steel, mu, {0.0, 0.0, 1e-4}};
    const auto s = solve_extrapolated(bound_of_ellipse(e, load, mu, 32, across), rail_steel, c.creepage, 1e-4);
    const double linear = kalker_linear(c).fy, off = std::abs(s.force.fy - linear) / (mu * load);
    INFO("a/b " << ratio << ": " << s.force.fy / linear << ", stated " << s.error_estimate << ", off " << off);
    CHECK(off < 2.5 * s.error_estimate + 0.005 * std::abs(linear) / (mu * load));  // the table has three digits
  }
}

TEST_CASE("a start from rest rolls into the steady state", "[laws][wheel_rail]") {
  const BoundLevels levels = bound_of_ellipse(ellipse, load, mu, 24, 12);
  const Creepage creepage{-0.001, 0.0003, 0.0};
  const auto steady = solve_steady_rolling(levels.back(), rail_steel, creepage);
  TangentialField field;
  HalfSpaceTangential step;
  double first = 0.0;
  for (int k = 0; k < 60; ++k) {  // two and a half lengths of the patch
    step = solve_rolling_step(levels.back(), rail_steel, creepage, field);
    REQUIRE(step.report.converged);
    field = step.traction;
    if (k == 0) first = step.force.fx;
  }
  CHECK(first < 0.3 * steady.force.fx);
  // what is left of the start fades as the inverse of the distance, not exponentially: 4e-3 here
  CHECK(step.force.fx == Approx(steady.force.fx).epsilon(6e-3));
  CHECK(step.force.fy == Approx(steady.force.fy).epsilon(6e-3));
}
