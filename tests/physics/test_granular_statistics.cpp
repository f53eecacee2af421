// Published statistics of granular matter (cases A35 to A40) on the scenes of scenes/library/granular. The whole ones
// are slow; shortened ones hold what a small scene can show.
#include <cmath>
#include <numeric>

#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

struct Line {
  double slope, offset, r2;
};

Line fit(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  const double mx = std::accumulate(x.begin(), x.end(), 0.0) / n, my = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t k = 0; k < x.size(); ++k)
    xx += (x[k] - mx) * (x[k] - mx), xy += (x[k] - mx) * (y[k] - my), yy += (y[k] - my) * (y[k] - my);
  return {xy / xx, my - xy / xx * mx, xy * xy / (xx * yy)};
}

/// Solid fraction and contacts per body once the cell carries its pressure.
struct Packing {
  double fraction, contacts, rattlers, pressure, kinetic;
};

Packing compress(const std::string& scene, const std::vector<std::string>& overrides) {
  SceneRun run = run_scene(scene, overrides);
  REQUIRE(run.failure.empty());
  const double target = *run.assembly->scene.cell->control.pressure;
  return {run.last("packing", "fraction"), run.last("contacts", "without_rattlers"), run.last("contacts", "rattlers"),
          run.last("stress", "pressure") / target, run.last("energy", "kinetic")};
}

/// Vertical force that walls and floor give the grains, and the grains' weight [N].
struct Balance {
  double floor, tube, weight;
};

Balance balance(const SceneRun& run) {
  const World& w = run.assembly->simulation->world;
  double mass = 0;
  for (Slot s = 0; s < w.size(); ++s)
    if (w.is_movable(s)) mass += 1 / w.inverse_mass[s];
  return {-run.last("on_floor", "z"), -run.last("on_tube", "z"), 9.81 * mass};
}

/// Mass per second through the hole between two times [kg/s].
double discharge(const std::string& hole, double from, double to, const std::vector<std::string>& more) {
  std::vector<std::string> overrides{"shape.floor.mesh.file=\"" + library("granular/orifice_" + hole + ".obj") + "\""};
  overrides.insert(overrides.end(), more.begin(), more.end());
  SceneRun run = prepare_scene(library("granular/orifice.toml"), overrides);
  run.simulation().start();
  const double dt = run.simulation().time_step;
  run.advance_to(static_cast<std::uint64_t>(from / dt));
  const double before = run.last("flow", "mass");
  run.advance_to(static_cast<std::uint64_t>(to / dt));
  REQUIRE(run.failure.empty());
  return (run.last("flow", "mass") - before) / (to - from);
}

/// Velocity and density over the depth, mean over the last part of a run.
struct FlowProfile {
  double exponent, mean_over_surface, density_spread, speed;
};

FlowProfile flow_profile(const std::vector<std::string>& overrides, double from, int samples) {
  SceneRun run = prepare_scene(library("granular/incline_flow.toml"), overrides);
  run.simulation().start();
  const std::uint64_t total = run.assembly->steps,
                      first = static_cast<std::uint64_t>(from / run.simulation().time_step);
  constexpr std::size_t bins = 30;
  std::vector<double> velocity(bins, 0.0), density(bins, 0.0);
  double speed = 0;
  for (int n = 1; n <= samples; ++n) {
    run.advance_to(first + (total - first) * static_cast<std::uint64_t>(n) / static_cast<std::uint64_t>(samples));
    REQUIRE(run.failure.empty());
    for (std::size_t k = 0; k < bins; ++k) {
      const double v = run.last("layers", "velocity_x_" + std::to_string(k));
      density[k] += run.last("layers", "density_" + std::to_string(k)) / samples;
      velocity[k] += std::isfinite(v) ? v / samples : 0.0;
    }
    speed += run.last("speed", "x") / samples;
  }
  // the core: layers of half a diameter, from the second above the base to where the density has fallen by a tenth
  std::size_t top = 4;
  while (top + 1 < bins && density[top + 1] > 0.9 * density[4]) ++top;
  double mean = 0, spread = 0, height = 0.5 * static_cast<double>(top + 1);
  std::vector<double> depth, drop;
  for (std::size_t k = 3; k + 1 < top; ++k) mean += density[k] / static_cast<double>(top - 4);
  for (std::size_t k = 3; k + 1 < top; ++k) spread += std::pow(density[k] / mean - 1, 2) / static_cast<double>(top - 4);
  Line best{0, 0, 0};
  double surface = 0;
  for (double us = velocity[top]; us < 1.2 * velocity[top]; us *= 1.002) {  // the speed of the surface itself is fitted
    depth.clear(), drop.clear();
    for (std::size_t k = 2; k < top; ++k)
      depth.push_back(std::log(height - 0.5 * (static_cast<double>(k) + 0.5))),
          drop.push_back(std::log(us - velocity[k]));
    if (const Line line = fit(depth, drop); line.r2 > best.r2) best = line, surface = us;
  }
  return {best.slope, speed / surface, std::sqrt(spread), speed};
}

/// Where the deposit is no longer a whole layer: bins of one diameter with fewer than w bodies, in diameters.
double front(const SceneRun& run, double d, int w) {
  std::vector<int> count(1000, 0);
  const World& world = run.assembly->simulation->world;
  for (Slot s = 0; s < world.size(); ++s)
    if (world.is_movable(s) && world.position[s].x() > 0) ++count[static_cast<std::size_t>(world.position[s].x() / d)];
  double x = 0;
  while (count[static_cast<std::size_t>(x)] >= w) x += 1;
  return x;
}

}  // namespace

TEST_CASE("a compressed cell of frictionless spheres jams isostatically (case A35, small)",
          "[physics][granular][A35]") {
  const Packing p = compress(
      "granular/jammed_spheres.toml",
      {"params.n=64", "params.start=0.12", "params.softness=1e-2", "run.duration=14.0", "world.domain.rate_limit=0.1"});
  CHECK(p.pressure == Approx(1.0).epsilon(0.05));  // it still shakes by 1 %
  CHECK(p.fraction == Approx(0.64).margin(0.03));  // 64 spheres
  CHECK(p.contacts > 5.7);
  CHECK(p.contacts < 6.8);  // above 6 by the pressure
}

TEST_CASE("frictionless spheres jam at 0.639 with six contacts (case A35)", "[physics][granular][A35][.open]") {
  const Packing p = compress("granular/jammed_spheres.toml", {});
  CHECK(p.pressure == Approx(1.0).epsilon(1e-2));
  CHECK(p.fraction == Approx(0.639).margin(0.003 + 0.005));  // 0.005: of 1000 bodies in place of 10^4
  CHECK(p.contacts == Approx(6.0).margin(0.05));
  const Packing rough = compress("granular/jammed_spheres.toml", {"params.mu=0.3"});
  CHECK(rough.fraction == Approx(0.593).margin(0.01));
  CHECK(rough.contacts == Approx(4.5).margin(0.2));
}

TEST_CASE("spherocylinders and ellipsoids jam at their published fractions (case A36)",
          "[physics][granular][A36][.open]") {
  CHECK(compress("granular/jammed_capsules.toml", {}).fraction == Approx(0.721).margin(0.01));
  CHECK(compress("granular/jammed_ellipsoids.toml", {}).fraction == Approx(0.74).margin(0.01));
}

TEST_CASE("a silo's wall and floor carry the weight, and the wall most of it (case A37)",
          "[physics][granular][A37][.open]") {
  SceneRun run = run_scene("granular/silo.toml");
  REQUIRE(run.failure.empty());
  const Balance b = balance(run);
  CHECK(std::abs(b.floor + b.tube - b.weight) < 1e-6 * b.weight);
  // stress against the weight above, sigma = P (1 - exp(-w/P)) with w the weight above per area, P = rho g lambda
  const World& w = run.simulation().world;
  const ContactSet& c = run.simulation().work.contacts;
  const double area = 0.25 * 3.14159265358979 * 0.01;
  const Slot tube = w.slot_of(run.assembly->body_ids[0]);
  double top = 0, bottom = 1;
  for (Slot s = 0; s < w.size(); ++s)
    if (w.is_movable(s)) top = std::max(top, w.position[s].z()), bottom = std::min(bottom, w.position[s].z());
  std::vector<double> above, stress;
  for (double z = bottom; z < top; z += 0.01) {
    double weight = 0, held = 0;
    for (Slot s = 0; s < w.size(); ++s)
      if (w.is_movable(s) && w.position[s].z() > z) weight += 9.81 / w.inverse_mass[s];
    for (std::size_t k = 0; k < c.size(); ++k) {
      if (c.a[k] != tube && c.b[k] != tube) continue;
      if (c.point(k, w).z() > z) held += c.a[k] == tube ? -c.force[k].z() : c.force[k].z();
    }
    above.push_back(weight / area), stress.push_back((weight - held) / area);
  }
  const auto misfit = [&](double p) {
    double sum = 0;
    for (std::size_t k = 0; k < above.size(); ++k) sum += std::pow(stress[k] - p * (1 - std::exp(-above[k] / p)), 2);
    return sum;
  };
  double best = 100;
  for (double p = 100; p < 5000; p *= 1.005)
    if (misfit(p) < misfit(best)) best = p;
  const double mean = std::accumulate(stress.begin(), stress.end(), 0.0) / static_cast<double>(stress.size());
  double spread = 0;
  for (double s : stress) spread += (s - mean) * (s - mean);
  CHECK(1 - misfit(best) / spread > 0.99);
  // P = rho_b g D/(4 mu K)
  const double bulk = b.weight / 9.81 / (area * (top - bottom));
  const double ratio = bulk * 9.81 * 0.1 / (4 * 0.5 * best);
  INFO("K " << ratio << ", bulk density " << bulk);
  CHECK(ratio > 0.4);
  CHECK(ratio < 0.8);
}

TEST_CASE("discharge through a hole goes like (D - 1.4 d)^2.5 (case A38)", "[physics][granular][A38][.open]") {
  std::vector<double> size, root;
  double six = 0, ten = 0;
  for (int hole : {6, 8, 10, 12}) {
    const double rate = discharge(std::to_string(hole), 0.4, 1.4, {});
    size.push_back(0.003 * hole), root.push_back(std::pow(rate, 0.4));
    if (hole == 6) six = rate;
    if (hole == 10) ten = rate;
  }
  CHECK(ten / six == Approx(4.779).epsilon(0.05));
  // W^(2/5) = (C rho_b sqrt(g))^(2/5) (D - k d)
  const Line line = fit(size, root);
  const double k = -line.offset / line.slope / 0.003, C = std::pow(line.slope, 2.5) / (1500 * std::sqrt(9.81));
  CHECK(line.r2 > 0.995);
  CHECK(k > 1.2);
  CHECK(k < 1.6);
  CHECK(C > 0.5);
  CHECK(C < 0.65);
}

TEST_CASE("a collapsing column runs out as far as its aspect ratio says and rests (case A39)",
          "[physics][granular][A39][.open]") {
  std::vector<double> log_a, log_reach;
  for (double a : {2.0, 4.0, 8.0}) {
    SceneRun run =
        run_scene("granular/column_collapse.toml", {"params.l0=10", "params.w=4", "params.a=" + std::to_string(a)});
    REQUIRE(run.failure.empty());
    const double reach = (front(run, 0.005, 4) - 10) / 10;
    log_a.push_back(std::log(a)), log_reach.push_back(std::log(reach));
    CHECK(run.last("energy", "kinetic") < 1e-4 * run.largest("energy", "kinetic"));
  }
  CHECK(fit(log_a, log_reach).slope == Approx(2.0 / 3).margin(0.08));
}

TEST_CASE("grains flow down a rough incline as Bagnold said (case A40)", "[physics][granular][A40][.open]") {
  const FlowProfile flow = flow_profile({}, 300.0, 100);
  CHECK(flow.exponent == Approx(1.5).margin(0.1));
  CHECK(flow.mean_over_surface == Approx(0.6).margin(0.04));
  CHECK(flow.density_spread < 0.02);
  CHECK(flow_profile({"params.theta_deg=18", "run.duration=200"}, 190.0, 1).speed < 1e-3);  // it has stopped
}
