// Creep laws against 56 half-space solutions (44 x 44 elements, themselves up to 3 % from their limit;
// tests/data/wheel_rail) and against each other where theory says they are equal.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

#include "laws/wheel_rail/tangential/fastsim.h"
#include "laws/wheel_rail/tangential/polach.h"
#include "laws/wheel_rail/tangential/shen_hedrick_elkins.h"
#include "laws/wheel_rail/tangential/strip_theory.h"
#include "laws/wheel_rail/tangential/vermeulen_johnson.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

struct CreepPoint {
  std::string kind;
  RollingCase rolling;
  double half_space_x, half_space_y;
  double parabolic_x, parabolic_y, elliptic_x, elliptic_y;  ///< the reference's own FASTSIM on the same cells
};

std::vector<CreepPoint> creep_points() {
  std::ifstream in(std::string(EPAFI_SOURCE_DIR) + "/tests/data/wheel_rail/creep_curves.csv");
  std::vector<CreepPoint> out;
  std::string line;
  std::getline(in, line);
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    CreepPoint p;
    double a, b, s, xi, eta, phi;
    row >> p.kind >> a >> b >> s >> xi >> eta >> phi >> p.half_space_x >> p.half_space_y >> p.parabolic_x >>
        p.parabolic_y >> p.elliptic_x >> p.elliptic_y;
    p.rolling = {{1e-3 * a, 1e-3 * b}, 82e3, {82e9, 0.28, 0.0}, 0.3, {xi, eta, 1e3 * phi}};
    out.push_back(p);
  }
  return out;
}

/// Largest |F - F_half-space| / (mu N) by kind of creepage.
template <class Law>
std::map<std::string, double> worst(const Law& law) {
  std::map<std::string, double> out{{"long", 0.0}, {"lat", 0.0}, {"spin", 0.0}, {"lat+spin", 0.0}};
  for (const CreepPoint& p : creep_points()) {
    const PatchForce f = law(p.rolling);
    const double bound = p.rolling.bound();
    double& w = out.at(p.kind);
    w = std::max(w, std::hypot(f.fx / bound - p.half_space_x, f.fy / bound - p.half_space_y));
  }
  return out;
}

KalkerCoefficients coefficients(const RollingCase& c) {
  return kalker_coefficients(c.ellipse.a / c.ellipse.b, c.elastic.poissons_ratio);
}

PatchForce fastsim_force(const RollingCase& c, std::uint32_t along, std::uint32_t across, Bound bound,
                         FlexibilityRule rule = FlexibilityRule::blended) {
  return fastsim(strips_of_ellipse(c.ellipse, c.normal_force, along, across, bound),
                 kalker_flexibility(c, coefficients(c), rule), c.friction, c.creepage, false)
      .force;
}

}  // namespace

TEST_CASE("56 points of creepage were read", "[laws][wheel_rail]") { CHECK(creep_points().size() == 56); }

TEST_CASE("Kalker's table is met at its places and runs smoothly between them", "[laws][wheel_rail]") {
  CHECK(kalker_coefficients(0.5, 0.25).c11 == Approx(3.62));
  CHECK(kalker_coefficients(2.0, 0.5).c22 == Approx(5.56));
  CHECK(kalker_coefficients(1.0, 0.0).c23 == Approx(1.33));
  CHECK(kalker_coefficients(0.1, 0.25).c33 == Approx(8.28));
  CHECK(kalker_coefficients(10.0, 0.25).c33 == Approx(0.526));
  CHECK(kalker_coefficients(1.0 / 0.7, 0.25).c11 == Approx(4.54));
  // without Poisson's ratio both directions are the same
  for (const double ratio : {0.15, 0.77, 1.3, 6.0})
    CHECK(kalker_coefficients(ratio, 0.0).c11 == Approx(kalker_coefficients(ratio, 0.0).c22));
  // leaving out every second place and interpolating it by cubics of double the step is off by less than two digits of
  // the table
  for (double ratio = 0.15; ratio < 1.0; ratio += 0.1) {
    const KalkerCoefficients k = kalker_coefficients(ratio, 0.25), l = kalker_coefficients(ratio - 0.05, 0.25),
                             r = kalker_coefficients(ratio + 0.05, 0.25);
    CHECK(k.c22 == Approx(0.5 * (l.c22 + r.c22)).margin(0.01));
  }
  CHECK_FALSE(kalker_coefficients(0.1, 0.25).extrapolated);
  CHECK(kalker_coefficients(0.05, 0.25).extrapolated);
  CHECK(kalker_coefficients(20.0, 0.25).extrapolated);
}

TEST_CASE("every law keeps within its distance of the half-space solution", "[laws][wheel_rail]") {
  // the columns published for these laws (44 x 44 cells): FASTSIM 0.035 / 0.083 for pure creepage / spin, FaStrip 0.018
  // / 0.045
  const auto parabolic = worst([](const RollingCase& c) { return fastsim_force(c, 44, 44, Bound::parabolic); });
  CHECK(parabolic.at("long") < 0.035);
  CHECK(parabolic.at("lat") < 0.032);
  CHECK(parabolic.at("spin") < 0.083);
  CHECK(parabolic.at("lat+spin") < 0.042);
  const auto elliptic = worst([](const RollingCase& c) { return fastsim_force(c, 44, 44, Bound::elliptic); });
  CHECK(elliptic.at("long") < 0.043);
  CHECK(elliptic.at("lat") < 0.047);  // 0.040 and 0.054 are published: the case below says what makes the difference
  CHECK(elliptic.at("spin") < 0.062);
  CHECK(elliptic.at("lat+spin") < 0.052);
  for (const std::uint32_t n : {20u, 44u, 100u}) {
    const auto fastrip_worst = worst([n](const RollingCase& c) {
      return fastrip(strips_of_ellipse(c.ellipse, c.normal_force, n, n, Bound::elliptic), c, coefficients(c), false)
          .force;
    });
    CHECK(fastrip_worst.at("long") < 0.018);
    CHECK(fastrip_worst.at("lat") < 0.018);
    CHECK(fastrip_worst.at("spin") < 0.045);
    CHECK(fastrip_worst.at("lat+spin") < 0.036);
  }
  const auto she = worst([](const RollingCase& c) { return shen_hedrick_elkins(c); });
  CHECK(she.at("long") < 0.038);
  CHECK(she.at("lat") < 0.033);
  CHECK(she.at("spin") == Approx(0.846).margin(0.005));  // where it fails
  const auto closed = worst([](const RollingCase& c) { return polach(c); });
  CHECK(closed.at("long") < 0.063);
  CHECK(closed.at("lat") < 0.060);
  const auto vj = worst([](const RollingCase& c) { return vermeulen_johnson(c); });
  CHECK(vj.at("long") < 0.068);
  CHECK(vj.at("lat") < 0.055);
}

TEST_CASE("on the cells of the published column FASTSIM has its values", "[laws][wheel_rail]") {
  // 44 x 44 whole cells over 1.1 times the ellipse instead of strips that end on it: 31 in the mean along a strip, and
  // FASTSIM is of first order in them; slip by spin a sixth of a cell ahead of its middle. So the reference's numbers
  // come out to 1e-3, and its distances to the half-space with them; converged, the law itself is 0.057 and 0.059 off
  // for lateral creepage and spin on the elliptic bound.
  constexpr std::size_t n = 44;
  std::map<std::string, double> off;
  for (const CreepPoint& p : creep_points()) {
    RollingCase c = p.rolling;
    const double dx = 2.2 * c.ellipse.a / n, dy = 2.2 * c.ellipse.b / n, bound = c.bound(),
                 p0 = 1.5 * c.normal_force / (std::numbers::pi * c.ellipse.a * c.ellipse.b);
    const PatchGrid g{n, n, dx, dy};
    std::vector<double> pressure(g.size());
    for (std::size_t k = 0; k < pressure.size(); ++k) {
      const double x = g.x(k % n) / c.ellipse.a, y = g.y(k / n) / c.ellipse.b;
      pressure[k] = p0 * std::sqrt(std::max(0.0, 1.0 - x * x - y * y));
    }
    const Flexibility L = kalker_flexibility(c, coefficients(c), FlexibilityRule::blended);
    c.creepage.lateral += c.creepage.spin * dx / 6.0 * L.lateral / L.spin;
    const auto force = [&](Bound b) {
      return fastsim(strips_of_field(g, pressure, b), L, c.friction, c.creepage, false).force;
    };
    const PatchForce elliptic = force(Bound::elliptic), parabolic = force(Bound::parabolic);
    INFO(p.kind << " a/b " << c.ellipse.a / c.ellipse.b << " half-space " << p.half_space_x << " " << p.half_space_y);
    if (p.kind != "lat+spin") {  // there it blends flexibilities by another rule
      CHECK(std::hypot(elliptic.fx / bound - p.elliptic_x, elliptic.fy / bound - p.elliptic_y) < 1e-3);
      CHECK(std::hypot(parabolic.fx / bound - p.parabolic_x, parabolic.fy / bound - p.parabolic_y) < 1e-3);
    }
    double& worst_here = off[p.kind];
    worst_here =
        std::max(worst_here, std::hypot(elliptic.fx / bound - p.half_space_x, elliptic.fy / bound - p.half_space_y));
  }
  CHECK(off.at("long") < 0.043);
  CHECK(off.at("lat") < 0.040);
  CHECK(off.at("spin") < 0.054);
  CHECK(off.at("lat+spin") < 0.052);
}

TEST_CASE("one flexibility that keeps the linear force beats the three for creepage with spin", "[laws][wheel_rail]") {
  const auto of = [](FlexibilityRule rule) {
    return worst([rule](const RollingCase& c) { return fastsim_force(c, 44, 44, Bound::parabolic, rule); })
        .at("lat+spin");
  };
  CHECK(of(FlexibilityRule::blended) < 0.5 * of(FlexibilityRule::three));
}

TEST_CASE("Polach with kA = kS = 1 equals converged FASTSIM on the elliptic bound for pure creepage",
          "[laws][wheel_rail]") {
  for (const CreepPoint& p : creep_points()) {
    if (p.kind != "lat" && p.kind != "long") continue;
    const RollingCase& c = p.rolling;
    // first order in the cells along x: two grids give the limit
    const PatchForce fine = fastsim_force(c, 1200, 60, Bound::elliptic),
                     half = fastsim_force(c, 600, 60, Bound::elliptic), closed = polach(c);
    CHECK(std::hypot(2.0 * fine.fx - half.fx - closed.fx, 2.0 * fine.fy - half.fy - closed.fy) < 1e-3 * c.bound());
  }
}

TEST_CASE("laws agree with Kalker's linear theory for vanishing creepage and with Coulomb for large",
          "[laws][wheel_rail]") {
  RollingCase c{{6e-3, 4e-3}, 5e4, {82e9, 0.28, 0.0}, 0.3, {}};
  const KalkerCoefficients k = coefficients(c);
  const auto strips = strips_of_ellipse(c.ellipse, c.normal_force, 400, 100, Bound::elliptic);
  // one creepage at a time: Polach and SHE point along the creepage or along the linear force, which differ where c11
  // and c22 do
  for (const Creepage one : {Creepage{1.0, 0.0, 0.0}, Creepage{0.0, -1.0, 0.0}}) {
    c.creepage = {1e-7 * one.longitudinal, 1e-7 * one.lateral, 0.0};
    const PatchForce linear = kalker_linear(c, k);
    for (const PatchForce& f : {shen_hedrick_elkins(c), polach(c), fastsim_force(c, 400, 100, Bound::parabolic)}) {
      CHECK(f.fx == Approx(linear.fx).epsilon(0.01));
      CHECK(f.fy == Approx(linear.fy).epsilon(0.01));
    }
    // strips whose stick begins within the first cell of 400
    CHECK(std::hypot(fastrip(strips, c, k, false).force.fx - linear.fx,
                     fastrip(strips, c, k, false).force.fy - linear.fy) < 0.02 * std::hypot(linear.fx, linear.fy));
    c.creepage = {0.05 * one.longitudinal, 0.05 * one.lateral, 0.0};
    for (const PatchForce& f : {shen_hedrick_elkins(c), vermeulen_johnson(c),
                                fastsim_force(c, 44, 44, Bound::parabolic), fastrip(strips, c, k, false).force}) {
      CHECK(f.fx == Approx(-one.longitudinal * c.bound()).epsilon(1e-6));
      CHECK(f.fy == Approx(-one.lateral * c.bound()).epsilon(1e-6));
    }
  }
  c.creepage = {};
  CHECK(fastrip(strips, c, k, false).force.fx == 0.0);
  CHECK(fastsim_force(c, 44, 44, Bound::parabolic).fy == 0.0);
}

TEST_CASE("a circle has Johnson's slopes in Vermeulen and Johnson's law", "[laws][wheel_rail]") {
  for (const double nu : {0.0, 0.25, 0.5}) {
    const auto k = vermeulen_johnson_slopes(1.0, nu);
    CHECK(k.longitudinal == Approx(16.0 / (4.0 - 3.0 * nu)).epsilon(1e-12));
    CHECK(k.lateral == Approx(16.0 / (4.0 - nu)).epsilon(1e-12));
    // continuous through the circle, where the formulas change
    CHECK(vermeulen_johnson_slopes(1.0 - 1e-7, nu).longitudinal ==
          Approx(vermeulen_johnson_slopes(1.0 + 1e-7, nu).longitudinal).epsilon(1e-6));
    CHECK(vermeulen_johnson_slopes(1.0 - 1e-7, nu).lateral ==
          Approx(vermeulen_johnson_slopes(1.0 + 1e-7, nu).lateral).epsilon(1e-6));
  }
}

TEST_CASE("strip theory on one strip is Carter's solution", "[laws][wheel_rail]") {
  // creepage = mu a / R (1 - sqrt(1 - Q/(mu N))), stick over sqrt(1 - Q/(mu N)) of the width  (Carter 1926)
  const double mu = 0.3, a = 1e-3, R = 0.5, G = 80e9, nu = 0.28, E = G / (1.0 - nu);
  const double N = std::numbers::pi * E * a * a / (4.0 * R);  // per length, a^2 = 4 N R / (pi E*)
  for (const double share : {0.1, 0.25, 0.5, 0.64, 0.9, 1.0}) {
    const double creepage = mu * a / R * (1.0 - std::sqrt(1.0 - share));
    const RollingCase c{{a, 0.5}, N, {G, nu, 0.0}, mu, {-creepage, 0.0, 0.0}};
    const StripSolution s = strip_theory(strip_of_line(c.ellipse, N, 1000), c, false);
    CHECK(s.force.fx / c.bound() == Approx(share).epsilon(1e-3));
    CHECK(s.stick_share == Approx(std::sqrt(1.0 - share)).margin(2e-3));
  }
}

TEST_CASE("mirrored creepages give mirrored forces", "[laws][wheel_rail]") {
  const RollingCase c{{5e-3, 7e-3}, 6e4, {80e9, 0.27, 0.0}, 0.35, {8e-4, -5e-4, 0.3}};
  RollingCase m = c;
  m.creepage.lateral = -c.creepage.lateral;
  m.creepage.spin = -c.creepage.spin;
  const auto strips = strips_of_ellipse(c.ellipse, c.normal_force, 40, 40, Bound::elliptic);
  const PatchForce pairs[][2] = {
      {fastrip(strips, c, coefficients(c), false).force, fastrip(strips, m, coefficients(m), false).force},
      {fastsim_force(c, 40, 40, Bound::parabolic), fastsim_force(m, 40, 40, Bound::parabolic)},
      {polach(c), polach(m)}};
  for (const auto& pair : pairs) {
    CHECK(pair[1].fx == Approx(pair[0].fx).epsilon(1e-10));
    CHECK(pair[1].fy == Approx(-pair[0].fy).epsilon(1e-10));
    CHECK(pair[1].mz == Approx(-pair[0].mz).epsilon(1e-10).margin(1e-9));
  }
}
