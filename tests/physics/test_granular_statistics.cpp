// Published statistics of granular matter (cases A35 to A40) on the scenes of scenes/library/granular. The whole ones
// are slow; shortened ones hold what a small scene can show.
#include <cmath>
#include <fstream>
#include <iomanip>
#include <numeric>

#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/viz_export/temporary_folder.h"

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
  for (std::size_t k = 0; k < x.size(); ++k) {
    xx += (x[k] - mx) * (x[k] - mx);
    xy += (x[k] - mx) * (y[k] - my);
    yy += (y[k] - my) * (y[k] - my);
  }
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

/// Free bodies as [[bodies]] of another scene reads them.
void write_bodies(const SceneRun& run, const std::filesystem::path& file) {
  const World& w = run.assembly->simulation->world;
  std::ofstream out(file);
  out << "x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz\n" << std::setprecision(17);
  for (Slot s = 0; s < w.size(); ++s) {
    if (!w.is_movable(s)) continue;
    for (const Vec3& v : {w.position[s], w.velocity[s]}) out << v.x() << ',' << v.y() << ',' << v.z() << ',';
    const Quat& q = w.orientation[s];
    const Vec3& spin = w.angular_velocity[s];
    out << q.w() << ',' << q.x() << ',' << q.y() << ',' << q.z() << ',' << spin.x() << ',' << spin.y() << ','
        << spin.z() << '\n';
  }
}

/// Elastic particles in a slowly shrinking cell, then at rest under a pressure that is let down.
Packing jam_from_gas(const std::string& grains) {
  const TemporaryFolder folder;
  const std::string file = (folder / "gas.csv").string();
  write_bodies(run_scene("granular/hard_" + grains + ".toml", {}), file);
  return compress("granular/jammed_" + grains + ".toml", {"bodies.pack.file=\"" + file + "\""});
}

/// P and R^2 of sigma = P (1 - exp(-w/P)) with w the weight above per area, P = rho_b g lambda.
std::pair<double, double> fit_janssen(const std::vector<double>& above, const std::vector<double>& stress) {
  const auto n = static_cast<double>(above.size());
  double mean = 0, spread = 0;
  for (double sigma : stress) mean += sigma / n;
  for (double sigma : stress) spread += (sigma - mean) * (sigma - mean);
  const auto misfit = [&](double p) {
    double sum = 0;
    for (std::size_t k = 0; k < above.size(); ++k) sum += std::pow(stress[k] - p * (1 - std::exp(-above[k] / p)), 2);
    return sum;
  };
  double best = 100;
  for (double p = 100; p < 5000; p *= 1.001)
    if (misfit(p) < misfit(best)) best = p;
  return {best, 1 - misfit(best) / spread};
}

constexpr double silo_area =
    12 * 0.05 * 0.05 * 0.267949192431123;  // twelve sides, 100 mm apart: 4 area/perimeter is 100 mm

/// The floor of the silo while the tube moves and after it.
struct SiloLoad {
  double above, moving;  ///< weight of the grains and mean load on the floor while the tube moves, per area [Pa]
  double imbalance;      ///< at rest: what floor and wall carry over the weight, less 1
  double density;        ///< of the packing, middle half of its height [kg/m^3]
};

/// The tube of the scene moves from 5 s to 2 s before the end; the load is even after some 40 mm of it, and swings by 6
/// % over a diameter of a grain: 250 mm are some 36 throws.
SiloLoad lift_silo(const std::string& fill) {
  SceneRun run = prepare_scene(library("granular/silo.toml"), {"params.fill=" + fill});
  run.simulation().start();
  const double dt = run.simulation().time_step, end = static_cast<double>(run.assembly->steps) * dt;
  double moving = 0, samples = 0;
  for (double t = end - 4.5; t < end - 2.0; t += 0.01) {
    run.advance_to(static_cast<std::uint64_t>(t / dt));
    REQUIRE(run.failure.empty());
    moving -= run.last("on_floor", "z");
    samples += 1;
  }
  run.advance_to(0);
  REQUIRE(run.failure.empty());
  const World& w = run.simulation().world;
  double mass = 0, moment = 0, middle = 0;
  for (Slot s = 0; s < w.size(); ++s)
    if (w.is_movable(s)) {
      mass += 1 / w.inverse_mass[s];
      moment += w.position[s].z() / w.inverse_mass[s];
    }
  const double height = 2 * moment / mass;
  for (Slot s = 0; s < w.size(); ++s)
    if (w.is_movable(s) && std::abs(w.position[s].z() - 0.5 * height) < 0.25 * height) middle += 1 / w.inverse_mass[s];
  const double carried = -run.last("on_floor", "z") - run.last("on_tube", "z");
  return {9.81 * mass / silo_area, moving / samples / silo_area, carried / (9.81 * mass) - 1,
          middle / (0.5 * height * silo_area)};
}

/// Mean rate between two times [kg/s], and by how much of it the second half is faster.
std::pair<double, double> discharge(const std::string& hole, double from, double to,
                                    std::vector<std::string> overrides = {}) {
  overrides.push_back("shape.floor.mesh.file=\"" + library("granular/orifice_" + hole + ".obj") + "\"");
  overrides.push_back("measure.flow.interval=5e-4");  // the scene's, 5 ms, would be 2 % of a half
  SceneRun run = prepare_scene(library("granular/orifice.toml"), overrides);
  run.simulation().start();
  const double dt = run.simulation().time_step, middle = 0.5 * (from + to);
  std::vector<double> mass;
  for (const double t : {from, middle, to}) {
    run.advance_to(static_cast<std::uint64_t>(std::ceil(t / dt)) + 1);  // past the sample at t
    REQUIRE(run.failure.empty());
    mass.push_back(run.last("flow", "mass"));
  }
  const double rate = (mass[2] - mass[0]) / (to - from);
  return {rate, (mass[2] - 2.0 * mass[1] + mass[0]) / (middle - from) / rate};
}

/// Of a steady flow: means over the last part of a run, in layers of one diameter.
struct FlowProfile {
  double exponent, r2;  ///< of u_s - u against the depth below the surface
  double mean_over_surface, density_spread, speed, depth;
};

/// The flow's layers without the three on the base, where balls lie in rows, and the three below the surface, where
/// they jump: Bagnold's profile is that of what lies between. The surface is where a column of the core's density would
/// end, its speed u_s that of the best fit.
FlowProfile fit_bagnold(const std::vector<double>& u, const std::vector<double>& density, double speed) {
  double core = 0.0;
  const std::size_t from = 3, inner = u.size() / 3;
  for (std::size_t k = from; k < inner; ++k) core += density[k] / static_cast<double>(inner - from);
  std::size_t top = 0;
  for (std::size_t k = 0; k < u.size(); ++k)
    if (density[k] > 0.5 * core) top = k;
  double h = static_cast<double>(top + 1) + density[top + 1] / core;
  if (density[top] < 0.9 * core) h += density[top] / core - 1.0;
  const std::size_t end = top - 3;
  double mean = 0.0, square = 0.0;
  for (std::size_t k = from; k < end; ++k) {
    mean += density[k] / static_cast<double>(end - from);
    square += density[k] * density[k] / static_cast<double>(end - from);
  }
  Line best{0, 0, 0};
  double surface = 0.0;
  for (double us = 1.001 * u[end - 1]; us < 1.5 * u[end - 1]; us *= 1.001) {
    std::vector<double> depth, drop;
    for (std::size_t k = from; k < end; ++k) {
      depth.push_back(std::log(h - static_cast<double>(k) - 0.5));
      drop.push_back(std::log(us - u[k]));
    }
    if (const Line line = fit(depth, drop); line.r2 > best.r2) {
      best = line;
      surface = us;
    }
  }
  return {best.slope, best.r2, speed / surface, std::sqrt(square / (mean * mean) - 1.0), speed, h};
}

FlowProfile flow_profile(const std::vector<std::string>& overrides, double from) {
  SceneRun run = prepare_scene(library("granular/incline_flow.toml"), overrides);
  run.simulation().start();
  const double dt = run.simulation().time_step;
  const auto every = static_cast<std::uint64_t>(0.5 / dt), first = static_cast<std::uint64_t>(from / dt);
  const std::size_t layers = 28;
  std::vector<double> u(layers, 0.0), density(layers, 0.0);
  double speed = 0.0, samples = 0.0;
  for (std::uint64_t step = first; step <= run.assembly->steps; step += every) {
    run.advance_to(step);
    REQUIRE(run.failure.empty());
    for (std::size_t k = 0; k < layers; ++k) {
      const double v = run.last("layers", "velocity_x_" + std::to_string(k));
      density[k] += run.last("layers", "density_" + std::to_string(k));
      u[k] += std::isfinite(v) ? v : 0.0;
    }
    speed += run.last("speed", "x");
    samples += 1.0;
  }
  for (std::size_t k = 0; k < layers; ++k) {
    u[k] /= samples;
    density[k] /= samples;
  }
  return fit_bagnold(u, density, speed / samples);
}

/// Mean velocity of the flow after some times.
std::vector<double> flow_speeds(const std::vector<std::string>& overrides, const std::vector<double>& times) {
  SceneRun run = prepare_scene(library("granular/incline_flow.toml"), overrides);
  run.simulation().start();
  std::vector<double> speeds;
  for (const double t : times) {
    run.advance_to(static_cast<std::uint64_t>(t / run.simulation().time_step));
    REQUIRE(run.failure.empty());
    speeds.push_back(run.last("speed", "x"));
  }
  return speeds;
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
          "[physics][granular][A35][long]") {
  const Packing p =
      compress("granular/jammed_spheres.toml", {"params.n=100", "params.start=0.12", "params.softness=1e-3",
                                                "params.ramp=5", "run.duration=8.0", "world.domain.rate_limit=1.0"});
  CHECK(p.pressure == Approx(1.0).epsilon(5e-3));
  CHECK(p.fraction == Approx(0.639).margin(0.02));  // cells of 100 scatter by 0.013 (O'Hern et al. 2003)
  CHECK(p.contacts > 6.0 - 4.0 / 100);              // N_c >= 3 N - 2
  CHECK(p.contacts < 6.8);                          // 6.4 at this pressure
}

TEST_CASE("frictionless spheres jam at 0.639 with six contacts (case A35)", "[physics][granular][A35][slow]") {
  const Packing p = compress("granular/jammed_spheres.toml", {});
  CHECK(p.pressure == Approx(1.0).epsilon(2e-3));
  // a cell of n spheres lies 0.12 n^-0.47 below an endless one; those of 1000 scatter by 0.003 (O'Hern et al. 2003)
  CHECK(p.fraction + 0.12 * std::pow(1000, -0.47) == Approx(0.639).margin(0.003 + 0.003));
  CHECK(p.contacts == Approx(6.0).margin(0.05));
  CHECK(p.rattlers < 40);
  const double held = 1000 - p.rattlers, number = 0.5 * p.contacts * held;
  // rigid, and hardly more; some contacts are open at the moment of the count: 7 of 2950 by the last tremor seen
  CHECK(number > 0.995 * (3 * held - 2));
  CHECK(number < 1.02 * (3 * held - 2));
  CHECK(p.kinetic < 1e-9);  // the contacts hold 1.6e-8 J
}

TEST_CASE("spheres with friction jam looser, with fewer contacts (case A35)", "[physics][granular][A35][slow]") {
  constexpr int cells = 4;  // those of 1000 scatter by 0.0025 about 0.588: one alone is at the margin now and then
  double pressure = 0.0, fraction = 0.0, contacts = 0.0;
  for (int seed = 1; seed <= cells; ++seed) {
    const Packing rough = compress(
        "granular/jammed_spheres.toml",
        {"params.mu=0.3", "params.first=1e-5", "params.ramp=1", "run.duration=16", "run.seed=" + std::to_string(seed)});
    pressure += rough.pressure / cells;
    fraction += rough.fraction / cells;
    contacts += rough.contacts / cells;
  }
  CHECK(pressure == Approx(1.0).epsilon(1e-3));
  CHECK(fraction == Approx(0.593).margin(0.01));
  CHECK(contacts == Approx(4.5).margin(0.2));
}

TEST_CASE("hard spherocylinders jam at their published fraction (case A36)", "[physics][granular][A36][slow]") {
  const Packing p = jam_from_gas("capsules");
  CHECK(p.pressure == Approx(1.0).epsilon(2e-3));
  CHECK(p.kinetic < 1e-8);
  CHECK(p.fraction == Approx(0.721).margin(0.01));
}

TEST_CASE("hard ellipsoids jam at their published fraction (case A36)", "[physics][granular][A36][slow]") {
  const Packing p = jam_from_gas("ellipsoids");
  CHECK(p.pressure == Approx(1.0).epsilon(2e-2));  // what is left takes 2e-7 of the volume
  CHECK(p.fraction == Approx(0.74).margin(0.01));
}

TEST_CASE("the floor of a silo carries what Janssen said, whatever stands above it (case A37)",
          "[physics][granular][A37][slow]") {
  std::vector<double> above, stress;
  double density = 0;
  for (const char* fill : {"0.5", "1", "2", "4.5", "6"}) {  // diameters of the tube; lambda is 0.9 of them
    const SiloLoad load = lift_silo(fill);
    above.push_back(load.above);
    stress.push_back(load.moving);
    density = load.density;
    UNSCOPED_INFO("fill " << fill << " D, weight " << load.above << " Pa, on the floor " << load.moving
                          << " Pa, at rest floor and wall over weight - 1: " << load.imbalance);
    CHECK(std::abs(load.imbalance) < 1e-6);
  }
  const auto [scale, r2] = fit_janssen(above, stress);
  const double ratio = density * 9.81 * 0.1 / (4 * 0.5 * scale);  // P = rho_b g D/(4 mu K)
  INFO("P " << scale << ", R2 " << r2 << ", K " << ratio << ", bulk density " << density);
  CHECK(r2 > 0.99);
  CHECK(ratio > 0.4);
  CHECK(ratio < 0.8);
  CHECK(stress[3] == Approx(stress[4]).epsilon(0.03));  // beyond 4 lambda
}

TEST_CASE("discharge through a hole goes like (D - k d)^2.5 (case A38)", "[physics][granular][A38][slow]") {
  struct Hole {
    int size;
    double from, to;  // [s]; longer where few grains run
  };
  std::vector<double> size, rate;
  for (const Hole& hole : {Hole{6, 0.85, 2.35}, Hole{8, 0.6, 1.35}, Hole{10, 0.35, 1.85}, Hole{12, 0.35, 0.85}}) {
    // those of 1 MPa, which the scene has, lose 2 % of their flow with the depth
    const auto [mean, change] =
        discharge(std::to_string(hole.size), hole.from, hole.to, {"material.grain.youngs_modulus=\"10 MPa\""});
    UNSCOPED_INFO("hole of " << hole.size << " d: " << mean << " kg/s, in the second half " << change << " more");
    size.push_back(hole.size);
    rate.push_back(mean);
    if (hole.size == 10) CHECK(std::abs(change) < 0.02);  // whatever the depth, 27 d to 16 d
  }
  // the k whose power 5/2 meets all rates best, by ratios; W = C rho_b sqrt(g) ((D - k) d)^2.5
  const auto against = [&](double k) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < size.size(); ++i) {
      x.push_back(std::log(0.003 * (size[i] - k)));
      y.push_back(std::log(rate[i]));
    }
    return std::pair(x, y);
  };
  double best = 0.0, least = infinity, factor = 0.0;
  for (double k = 1.0; k < 2.0; k += 0.005) {
    const auto [x, y] = against(k);
    double mean = 0.0, square = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) mean += (y[i] - 2.5 * x[i]) / static_cast<double>(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) square += std::pow(y[i] - 2.5 * x[i] - mean, 2);
    if (square < least) {
      least = square;
      best = k;
      factor = std::exp(mean) / (1500 * std::sqrt(9.81));
    }
  }
  const auto [x, y] = against(best);
  INFO("k " << best << ", C " << factor << ", free exponent " << fit(x, y).slope << ", W(10)/W(6) "
            << rate[2] / rate[0]);
  CHECK(best > 1.2);
  // These two fail: k 1.62 to 1.70 and ratios of 4.99 to 5.11 have been seen, soft, stiff and rigid
  // (docs/granular_statistics.md).
  CHECK(best < 1.6);
  CHECK(rate[2] / rate[0] == Approx(4.779).epsilon(0.05));
  CHECK(fit(x, y).slope == Approx(2.5).margin(0.05));
  CHECK(factor > 0.5);
  CHECK(factor < 0.65);
}

TEST_CASE("rigid grains run out as fast as stiff ones (case A38)", "[physics][granular][A38][slow]") {
  // 10 MPa: grains of 1 MPa run out 4 % faster than these
  const double stiff = discharge("10", 0.35, 0.65, {"material.grain.youngs_modulus=\"10 MPa\""}).first;
  const double rigid = discharge("10", 0.35, 0.65, {"contact.method=nonsmooth", "run.time_step=5e-4"}).first;
  CHECK(rigid == Approx(stiff).epsilon(0.05));
}

TEST_CASE("a collapsing column runs out as far as its aspect ratio says and rests (case A39)",
          "[physics][granular][A39][slow]") {
  std::vector<double> log_a, log_reach;
  for (double a : {2.0, 4.0, 8.0, 16.0}) {
    SceneRun run = run_scene("granular/column_collapse.toml", {"params.a=" + std::to_string(a)});
    REQUIRE(run.failure.empty());
    const double reach = (front(run, 0.005, 3) - 16) / 16;
    INFO("a " << a << ", run-out " << reach);
    CHECK(reach == Approx(1.9 * std::pow(a, 2.0 / 3)).epsilon(0.2));
    log_a.push_back(std::log(a));
    log_reach.push_back(std::log(reach));
    CHECK(run.last("energy", "kinetic") < 1e-4 * run.largest("energy", "kinetic"));
  }
  CHECK(fit(log_a, log_reach).slope == Approx(2.0 / 3).margin(0.08));
}

TEST_CASE("grains flow down a rough incline as Bagnold said (case A40)", "[physics][granular][A40][slow]") {
  const FlowProfile flow = flow_profile({}, 60.0);
  INFO("depth " << flow.depth << ", fit " << flow.r2);
  CHECK(flow.r2 > 0.999);
  CHECK(flow.exponent == Approx(1.5).margin(0.1));
  CHECK(flow.mean_over_surface == Approx(0.6).margin(0.04));
  CHECK(flow.density_spread < 0.02);
}

TEST_CASE("a flow rests below 19 degrees and runs away at 30 (case A40)", "[physics][granular][A40][slow]") {
  const std::vector<std::string> half{"params.layers=14", "params.surface=1.0", "run.duration=100"};
  const auto with = [&](const char* angle) {
    auto all = half;
    all.push_back(angle);
    return all;
  };
  CHECK(std::abs(flow_speeds(with("params.theta_deg=19"), {99.0}).back()) < 1e-3);
  const auto fast = flow_speeds(with("params.theta_deg=30"), {20.0, 30.0, 40.0});
  CHECK(fast[2] - fast[1] > 0.7 * (fast[1] - fast[0]));  // 0.54 and 0.50 seen: it has no speed of its own
  CHECK(fast[1] - fast[0] > 0.0);
}

TEST_CASE("a thin flow is faster the steeper the incline, and stops on a flat one (case A40, short)",
          "[physics][granular][A40][long]") {
  const std::vector<std::string> thin{"params.layers=6", "params.lx=5", "params.ly=4", "params.surface=1.0",
                                      "run.time_step=4e-4"};
  std::vector<double> speed;
  for (const char* angle : {"params.theta_deg=10", "params.theta_deg=30", "params.theta_deg=35"}) {
    auto all = thin;
    all.push_back(angle);
    speed.push_back(flow_speeds(all, {12.0}).back());
  }
  CHECK(std::abs(speed[0]) < 1e-2);
  CHECK(speed[1] > 0.5);
  CHECK(speed[2] > 1.2 * speed[1]);
}
