// A wheelset on rails in the engine's own step: Klingel's wave, hunting against a linear analysis of the same model,
// curving, wheel flats, the ledger.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "detection/profiles/wheel_rail.h"
#include "engine/state/rotation.h"
#include "laws/wheel_rail/normal/hertz_ellipse.h"
#include "scenes/railway/profiles.h"
#include "tests/support/catch.h"
#include "tests/support/wheelset_case.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// Rolling radius difference of the elastic contact, for a wheelset that stands at y without yaw: with height, roll,
/// lateral velocity, turning and yaw rate such that the rails accelerate it in no direction, it yaws by
/// -delta_r V / (r0 s).
double elastic_difference(SceneRun& run, double y, Eigen::Matrix<double, 5, 1>& q) {
  Simulation& sim = run.simulation();
  World& w = sim.world;
  const Slot s = w.slot_of(BodyId{1});
  const double speed = w.velocity[s].x();
  const Vec3 x0(w.position[s].x(), y, w.position[s].z()), turning = w.angular_velocity[s];
  using Five = Eigen::Matrix<double, 5, 1>;
  const auto rest = [&](const Five& u) {
    w.position[s] = x0 + u[0] * Vec3::UnitZ();
    w.orientation[s] = Quat(Eigen::AngleAxisd(u[1], Vec3::UnitX()));
    w.velocity[s] = Vec3(speed, u[2], 0.0);
    w.angular_velocity[s] = Vec3(0.0, turning.y() + u[3], u[4]);
    const auto a = accelerations(sim, s);
    return Five(a[0], a[1], a[2], a[3], a[5]);
  };
  const double steps[5] = {1e-6, 1e-6, 1e-3, 1e-3, 1e-3};
  for (int round = 0; round < 30; ++round) {
    const Five r = rest(q);
    Eigen::Matrix<double, 5, 5> J;
    for (int k = 0; k < 5; ++k)
      J.col(k) = (rest(q + steps[k] * Five::Unit(k)) - rest(q - steps[k] * Five::Unit(k))) / (2.0 * steps[k]);
    const Five step = J.fullPivLu().solve(r);
    q -= step;
    if (std::abs(step[4]) < 1e-6 * speed) break;
  }
  // the axle lies at the roll angle, so that spinning about it turns with the yaw: the yaw rate is that of the axle
  const double yaw_rate = q[4] * std::cos(q[1]) - (turning.y() + q[3]) * std::sin(q[1]);
  return -r0 * 1.5 * yaw_rate / speed;
}

struct KlingelRow {
  const char *name, *normal;
  double start, duration, scale = 1.0, dt = 2e-4;
  bool elastic = false;  ///< conicity of the loaded contact instead of the rigid points
  double within = 0.01, ledger = 1e-5;
};

/// Conicity at this amplitude of the axle [m]: EN 15302 on rigid points, or the same from the elastic contact.
double conicity_at(const WheelsetCase& c, double axle, bool elastic) {
  const Profile rail = rail_of_all();
  // the conicity counts the amplitude at the rails
  const double at_rails = axle - r0 * stand_on_rails(wheel_of(c), rail, {}, {axle, 0.0, 0.0, 0.0}).position.roll;
  if (!elastic) return equivalent_conicity(wheel_of(c), rail, {}, at_rails);
  constexpr int n = 24;
  std::vector<double> difference(2 * n + 1, 0.0);
  WheelsetCase still = c;
  still.start = 0.0;
  SceneRun run = start_text(text_of(still));
  run.advance_to(200);  // it has come to rest on its springs nearly; the rest is solved for
  Eigen::Matrix<double, 5, 1> start = Eigen::Matrix<double, 5, 1>::Zero();
  for (int k = 0; k <= n; ++k) {
    difference[n + k] = elastic_difference(run, axle * k / n, start);
    difference[n - k] = -difference[n + k];
  }
  return conicity_of(difference, at_rails, {});
}

void check_klingel(std::initializer_list<KlingelRow> rows) {
  // L = 2 pi sqrt(r0 s / (2 lambda)), lambda the equivalent conicity at the wave's amplitude
  for (const KlingelRow& row : rows) {
    WheelsetCase c;
    c.wheel = fmt::format("name = \"{}\"", row.name);
    c.normal = row.normal;
    c.start = row.start;
    c.duration = row.duration;
    c.scale = row.scale;
    c.dt = row.dt;
    Trace t = trace_of(c);
    const auto x = crossings(t);
    REQUIRE(x.size() > 2);
    double high = -1.0, low = 1.0;
    for (std::size_t k = 0; k < t.time.size(); ++k)
      if (t.time[k] > x[0] && t.time[k] < x[2]) {
        high = std::max(high, t.lateral[k]);
        low = std::min(low, t.lateral[k]);
      }
    const double axle = 0.5 * (high - low), lambda = conicity_at(c, axle, row.elastic);
    const double wave = c.speed * (x[2] - x[0]), klingel = 2.0 * pi * std::sqrt(r0 * 1.5 / (2.0 * lambda));
    INFO(row.name << " " << row.normal << " amplitude " << axle << ": wave " << wave << " m, Klingel " << klingel
                  << " m");
    CHECK(wave == Approx(klingel).epsilon(row.within));
    CHECK(std::abs(t.run.energy_error()) < row.ledger);
  }
}

}  // namespace

TEST_CASE("a free wheelset rolls on Klingel's wave", "[physics][wheelset][long]") {
  check_klingel({{"cone", "hertz", 1e-3, 2.5}, {"s1002", "semi-hertz", 3e-3, 1.5}});
}

TEST_CASE("Klingel's wave of strips on a cone and of a smaller swing", "[physics][wheelset][slow]") {
  // at 1.3 mm the loaded contact still has 3 % more wave than rigid points (6.98 m, 6.79 m)
  check_klingel({{"cone", "semi-hertz", 1e-3, 2.5}, {"s1002", "semi-hertz", 1.5e-3, 1.2, 1.0, 2e-4, true}});
}

TEST_CASE("a swing smaller than the patch is wide is Klingel's under a light load", "[physics][wheelset][slow]") {
  // Rigid points of S1002 on UIC60 jump by 10 mm at 0.25 mm. Under a thousandth of the load the patch is small against
  // that and the wave is that of the rigid points (6.022 m, 6.033 m at 0.95 mm). Under 32 kN it spreads over the jump:
  // rigid points would make the wave 5.95 m at 0.92 mm and 4.57 m at 0.45 mm.
  check_klingel({{"s1002", "semi-hertz", 1e-3, 1.2, 1e-3, 2e-5, false, 0.01, 1e-3}});
}

TEST_CASE("a small swing under load has the conicity of the elastic contact", "[physics][wheelset][slow]") {
  // 6.57 m for 6.62 m at 0.88 mm, 6.195 m for 6.202 m at 0.46 mm, where rigid points would make it 5.95 and 4.57 m
  check_klingel({{"s1002", "semi-hertz", 1e-3, 1.2, 1.0, 2e-4, true, 0.01, 1e-5},
                 {"s1002", "semi-hertz", 0.5e-3, 1.2, 1.0, 2e-4, true, 0.01, 1e-5},
                 {"s1002", "semi-hertz", 0.05e-3, 1.2, 1.0, 2e-4, true, 0.01, 1e-5}});
}

TEST_CASE("a cone's wave is that of its elastic contact and of its eigenvalues", "[physics][wheelset]") {
  // 16.301 m, 16.306 m in motion; the eigenvalues are those of the equations of motion linearised at rest
  WheelsetCase c;
  const double lambda = conicity_at(c, 0.2e-3, true), wave = 2.0 * pi * std::sqrt(r0 * 1.5 / (2.0 * lambda));
  CHECK(wave == Approx(2.0 * pi * std::sqrt(r0 * 1.5 / (2.0 * conicity_at(c, 0.2e-3, false)))).epsilon(0.005));
  c.start = 0.0;
  c.duration = 0.5;
  SceneRun run = start_text(text_of(c));
  run.advance_to(0);
  const Eigen::EigenSolver<Eigen::Matrix<double, 12, 12>> modes(linearised(run));
  double rate = 0.0;  // the one oscillation slower than 10 Hz
  for (int k = 0; k < 12; ++k) {
    const double w = modes.eigenvalues()[k].imag();
    if (w > 1.0 && w < 60.0) rate = w;
  }
  CHECK(2.0 * pi * c.speed / rate == Approx(wave).epsilon(0.005));
}

TEST_CASE("hunting begins where the linear analysis of the same model says", "[physics][wheelset][slow]") {
  const auto linear = [](double v) {
    WheelsetCase c = hunting();
    c.speed = v;
    return linear_growth(c);
  };
  const double critical = critical_speed(40.0, 60.0, 0.02, linear);
  INFO("linear critical speed " << critical << " m/s");
  for (const double factor : {0.97, 1.03}) {
    WheelsetCase c = hunting();
    c.speed = factor * critical;
    c.start = 5e-5;
    c.duration = 4.0;
    const double rate = growth(trace_of(c), 1.0), expected = linear(c.speed);
    INFO("at " << c.speed << " m/s: " << rate << " /s, linear " << expected << " /s");
    CHECK((factor < 1.0 ? rate < 0.0 : rate > 0.0));
    CHECK(rate == Approx(expected).margin(0.02));  // the swing has 3.5 Hz
  }
}

TEST_CASE("the critical speed is the same for two time steps", "[physics][wheelset][slow]") {
  std::vector<double> found;
  for (const double dt : {2e-4, 1e-4}) {
    found.push_back(critical_speed(48.0, 54.0, 0.05, [&](double v) {
      WheelsetCase c = hunting();
      c.speed = v;
      c.dt = dt;
      c.start = 5e-5;
      c.duration = 5.0;
      return growth(trace_of(c), 1.0);
    }));
  }
  const double linear = critical_speed(48.0, 54.0, 0.02, [](double v) {
    WheelsetCase c = hunting();
    c.speed = v;
    return linear_growth(c);
  });
  WARN(fmt::format("critical speed {:.3f} m/s (dt 0.2 ms), {:.3f} m/s (0.1 ms), linear {:.3f} m/s", found[0], found[1],
                   linear));
  CHECK(found[0] == Approx(found[1]).epsilon(0.01));
  CHECK(found[0] == Approx(linear).epsilon(0.01));
}

TEST_CASE("above the critical speed the wheelset swings in a limit cycle", "[physics][wheelset][slow]") {
  // From both sides: a small start grows to the amplitude that a large one falls to, 3.778 mm to either side. The
  // springs must be at rest over the middle: at rest where the run starts they pull 1 % of that to one side.
  double widest[2][2];  // by start, to the right and to the left
  for (const int k : {0, 1}) {
    SceneRun run = prepare_scene(library("wheel_rail/wheelset.toml"),
                                 {"params.wave=0", "params.v=40", "params.kx=5e5", "params.ky=2e5", "run.duration=12",
                                  fmt::format("params.start={}", k == 0 ? 2e-3 : 5e-3)});
    Simulation& sim = run.simulation();
    sim.start();
    double early = 0.0, right = 0.0, left = 0.0;
    while (sim.steps() < run.assembly->steps) {
      REQUIRE_FALSE(sim.advance());
      const double y = sim.world.position[sim.world.slot_of(BodyId{1})].y();
      if (sim.world.time > 8.0 && sim.world.time < 10.0) early = std::max(early, y);
      if (sim.world.time >= 10.0) {
        right = std::max(right, y);
        left = std::max(left, -y);
      }
    }
    CHECK(right == Approx(early).epsilon(1e-3));
    CHECK(right == Approx(left).epsilon(1e-3));
    widest[k][0] = right;
    widest[k][1] = left;
  }
  WARN(fmt::format("limit cycle at 40 m/s: {:.4f} and {:.4f} mm", 1e3 * widest[0][0], 1e3 * widest[1][0]));
  CHECK(widest[0][0] == Approx(widest[1][0]).epsilon(1e-3));
  CHECK(widest[0][0] > 2e-3);
}

TEST_CASE("in a curve a cone moves outwards until both wheels roll", "[physics][wheelset][slow]") {
  // delta_r = 2 lambda y = r0 s / R: y = r0 s / (2 lambda R)
  const double R = 2000.0;
  WheelsetCase c;
  c.speed = 20.0;
  c.start = 0.0;
  c.duration = 9.0;
  c.dt = 4e-4;
  std::string text = text_of(c);
  const std::string rail = "cant = \"= atan(1/40)\"";
  text.replace(text.find(rail), rail.size(),
               rail + fmt::format(", curve = {{ radius = {}, start = 10, transition = 80, superelevation = {:.6g} }}",
                                  R, 1.505 * c.speed * c.speed / (9.81 * R)));
  for (std::size_t at; (at = text.find("damping = [0, 0, 10000]")) != std::string::npos;)
    text.replace(at, 23, "damping = [5e4, 3e4, 1e4]");  // or Klingel's wave goes on for ever
  // the load leans with the frame, or its part along the sleepers pushes the wheelset aside
  text.replace(text.find("force = [0, 0, 50000]"), 21, "");
  for (std::size_t at = 0; (at = text.find("[[spring]]\n", at)) != std::string::npos; at += 20)
    text.insert(at + 11, "preload = [0, 0, 25e3]\n");
  const double lambda = equivalent_conicity(wheel_of(c), rail_of_all(), {}, 3e-3);
  // mean over the last of Klingel's waves, which hardly die away
  const double wave = 2.0 * pi * std::sqrt(r0 * 1.5 / (2.0 * lambda)) / c.speed;
  const auto mean_place = [&](SceneRun& run) {
    double sum = 0.0, n = 0.0;
    Simulation& sim = run.simulation();
    while (sim.steps() < run.assembly->steps) {
      REQUIRE_FALSE(sim.advance());
      if (sim.world.time < c.duration - wave) continue;
      sum += run.last("run", "lateral") - r0 * run.last("run", "roll");  // at the rails
      n += 1.0;
    }
    return sum / n;
  };
  SceneRun run = start_text(text);
  const double y = mean_place(run);
  CHECK(y == Approx(-r0 * 1.5 / (2.0 * lambda * R)).epsilon(0.01));
  CHECK(std::abs(run.last("run", "yaw")) < 2e-4);  // radial
  CHECK(std::abs(run.energy_error()) < 1e-4);
  // the same curve to the left is its mirror image
  const std::string right = fmt::format("radius = {}", R);
  text.replace(text.find(right), right.size(), fmt::format("radius = {}", -R));
  SceneRun left = start_text(text);
  CHECK(mean_place(left) == Approx(-y).epsilon(1e-6));
}

TEST_CASE("a flat strikes with the speed of its edges", "[physics][wheelset][slow]") {
  // The axle turns about the first edge, then about the second: its vertical speed jumps by v l / R, which the contact
  // springs take up. (A heavy spin, for the fall about an edge drives the wheel.) With N = C delta^(3/2) from the
  // static load N0: m dv^2 / 2 = integral of N - N0 from delta0 to the peak. Slow, so that the oscillation which the
  // first edge starts is small: its speed is v / (l omega) = 0.7 % of dv.
  const double v = 0.5, l = 0.06;
  WheelsetCase c;
  c.wheel = "name = \"cone\", flat = { length = 0.06, angle_deg = 20 }";
  c.speed = v;
  c.start = 0.0;
  c.dt = 1e-5;
  c.duration = 0.36;
  c.tangential = "none";
  std::string text = text_of(c);
  text.replace(text.find("[950, 120, 950]"), 15, "[9500, 12000, 9500]");
  SceneRun run = start_text(text);
  Simulation& sim = run.simulation();
  double before = 0.0, delta = 0.0, peak = 0.0;
  const double reached = pi / 9.0 * r0 / v;  // the middle of the flat is down
  while (sim.steps() < run.assembly->steps) {
    REQUIRE_FALSE(sim.advance());
    const double N = -run.last("run", "left_z");
    if (sim.world.time < reached - 0.06) {
      before = N;
      delta = run.assembly->rolling->all.front().approach;
    }
    if (sim.world.time > reached - 1e-3) peak = std::max(peak, N);
  }
  CHECK(before == Approx(wheel_load).epsilon(0.02));
  // on a wheel that turns about its edge the load is less by m v^2 / R; the jump is 2 v (l/2) / R
  const double C = before / (delta * std::sqrt(delta)), m = 750.0, N0 = before - m * v * v / r0, speed = v * l / r0;
  const double d0 = std::cbrt(N0 / C * (N0 / C)), energy = 0.5 * m * speed * speed;
  double d = d0;
  for (int k = 0; k < 100; ++k) {
    const double taken = 0.4 * C * (d * d * std::sqrt(d) - d0 * d0 * std::sqrt(d0)) - N0 * (d - d0);
    const double force = C * d * std::sqrt(d) - N0;
    d += (energy - taken) / std::max(force, 0.05 * N0);
  }
  INFO("static " << before << " N, peak " << peak << " N");
  CHECK(peak == Approx(C * d * std::sqrt(d)).epsilon(0.03));
  CHECK(peak > 2.0 * before);
}

TEST_CASE("a cylinder that slides rolls on with two thirds of its speed", "[physics][wheelset]") {
  // About the line of contact m r v + I omega stays: v = v0 / (1 + I / (m r^2)), after v0 / (mu g (1 + m r^2 / I));
  // with I = m r^2 / 2 that is 2/3 v0 after v0 / (3 mu g), and a third of the energy is lost.
  const double v0 = 1.0, r = 0.1, mu = 0.3, stop = v0 / (3.0 * mu * 9.81);
  for (const char* method : {"smooth", "nonsmooth"}) {
    INFO(method);
    SceneRun run = prepare_scene(library("wheel_rail/cylinder.toml"), {fmt::format("contact.method=\"{}\"", method)});
    Simulation& sim = run.simulation();
    sim.start();
    while (sim.world.time < 0.5 * stop) REQUIRE_FALSE(sim.advance());
    CHECK(sim.world.velocity[sim.world.slot_of(BodyId{1})].x() ==
          Approx(v0 - mu * 9.81 * sim.world.time).epsilon(1e-4));
    // a spring of friction without damper swings on by 1 %; the momentum about the line of contact stays all the way
    double sum = 0.0, count = 0.0;
    while (sim.steps() < run.assembly->steps) {
      REQUIRE_FALSE(sim.advance());
      const Slot s = sim.world.slot_of(BodyId{1});
      const double v = sim.world.velocity[s].x(), turning = sim.world.angular_velocity[s].y();
      if (sim.world.time > 1.5 * stop) {
        sum += v;
        count += 1.0;
      }
      if (sim.steps() % 1000 == 0) CHECK(v + 0.5 * r * turning == Approx(v0).epsilon(1e-4));
    }
    CHECK(sum / count == Approx(2.0 / 3.0 * v0).epsilon(1e-3));
    const Energy e = sim.ledger.measure(sim.world);
    CHECK(e.kinetic == Approx(2.0 * e.dissipated).epsilon(1e-3));
  }
}

TEST_CASE("a wheelset of two cylinders that slides rolls on by the same balance", "[physics][wheelset]") {
  // whatever the creep law: the rails' forces act at the tread
  WheelsetCase c;
  c.wheel = "name = \"cone\", conicity = 0";
  c.tangential = "shen-hedrick-elkins";
  c.start = 0.0;
  c.duration = 0.6;
  std::string text = text_of(c);
  const std::string turning = fmt::format("angular_velocity = [0, {:.17g}, 0]", -c.speed / r0);
  text.replace(text.find(turning), turning.size(), "angular_velocity = [0, 0, 0]");
  const double ratio = 1500.0 * r0 * r0 / 120.0, g = 2.0 * wheel_load / 1500.0;
  SceneRun run = start_text(text);
  Simulation& sim = run.simulation();
  const double stop = c.speed / (0.3 * g * (1.0 + ratio));
  REQUIRE(stop < 0.5 * c.duration);
  while (sim.world.time < 0.3 * stop) REQUIRE_FALSE(sim.advance());
  const auto velocity = [&] { return sim.world.velocity[sim.world.slot_of(BodyId{1})]; };
  const double from = sim.world.time;
  const Vec3 first = velocity();
  while (sim.world.time < 0.8 * stop) REQUIRE_FALSE(sim.advance());
  // it bounces on its contact springs meanwhile: what the rails hold up is the load less what it falls faster (z down)
  const Vec3 change = velocity() - first;
  CHECK(-change.x() == Approx(0.3 * (g * (sim.world.time - from) - change.z())).epsilon(0.01));
  run.advance_to(0);
  const double v = c.speed / (1.0 + 1.0 / ratio);
  const Slot s = sim.world.slot_of(BodyId{1});
  CHECK(sim.world.velocity[s].x() == Approx(v).epsilon(1e-3));
  CHECK(-sim.world.angular_velocity[s].y() * r0 == Approx(v).epsilon(1e-3));
}

TEST_CASE("rigid contact takes the same way as the laws of rolling contact", "[physics][wheelset][long]") {
  const std::vector<std::string> sets{"run.duration=0.8", "bounds.energy_error=1"};
  const SceneRun soft = run_scene("wheel_rail/wheelset.toml", sets);
  auto rigid_sets = sets;
  rigid_sets.push_back("contact.method=\"nonsmooth\"");
  const SceneRun rigid = run_scene("wheel_rail/wheelset.toml", rigid_sets);
  // creep: 0.2 mm on a wave of 3 mm
  CHECK(rigid.last("run", "lateral") == Approx(soft.last("run", "lateral")).margin(3e-4));
  CHECK(rigid.last("run", "right_z") == Approx(soft.last("run", "right_z")).epsilon(0.03));
}

TEST_CASE("any pair of models runs in the step", "[physics][wheelset][long]") {
  // on a cone all normal models see the same parabola, all tangential ones the same small creepage: forces agree
  const auto run_with = [](const char* normal, const char* tangential, double duration) {
    WheelsetCase c;
    c.normal = normal;
    c.tangential = tangential;
    c.duration = duration;
    c.start = 2e-3;
    c.yaw = 1e-4;
    c.kx = 1e6;  // pulls to the middle with 1 kN a wheel
    c.ky = 5e5;
    SceneRun run = start_text(text_of(c));
    run.advance_to(0);
    REQUIRE(run.failure.empty());
    return std::pair(run.last("run", "left_y"), run.last("run", "lateral") - c.start);
  };
  const auto [force, crept] = run_with("hertz", "fastsim", 0.02);
  REQUIRE(std::abs(force) > 500.0);
  for (const char* tangential : {"shen-hedrick-elkins", "fastsim-elliptic", "fastrip"})
    CHECK(run_with("hertz", tangential, 0.02).first == Approx(force).epsilon(0.12));
  // it knows no slip and creeps less under the same pull
  CHECK(std::abs(run_with("hertz", "kalker-linear", 0.02).second) < 0.99 * std::abs(crept));
  for (const char* normal : {"multi-hertz", "semi-hertz"})
    CHECK(run_with(normal, "fastsim", 0.02).first == Approx(force).epsilon(0.03));
  CHECK(run_with("kik-piotrowski", "fastsim", 0.02).first == Approx(force).epsilon(0.12));  // its patch is wider
  CHECK(run_with("half-space", "polach", 0.01).second ==
        Approx(run_with("hertz", "polach", 0.01).second).epsilon(0.03));
}

TEST_CASE("the ledger of a wheelset closes and shows the price of creep", "[physics][wheelset][long]") {
  SceneRun run = run_scene("wheel_rail/wheelset.toml", {"run.duration=1"});
  REQUIRE(run.failure.empty());
  Simulation& sim = run.simulation();
  const Energy e = sim.ledger.measure(sim.world);
  CHECK(e.losses.frictional > 10.0);
  // what is left unaccounted is small against what creep took, not against the motion of 400 kJ alone
  CHECK(std::abs(sim.ledger.relative_error()) * e.kinetic < 0.1 * e.dissipated);
}

TEST_CASE("what is wrong with wheels, tracks and springs is said with place and remedy", "[physics][wheelset][door]") {
  const std::string whole = text_of({});
  const auto problems = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
    std::string all;
    for (const Problem& p : read_scene_text(text, "scene.toml", {}, full_registry()).problems)
      all += p.to_string() + "\n";
    return all;
  };
  using Catch::Matchers::Contains;
  CHECK(problems("name = \"uic60\"", "name = \"uic60\"") ==
        "scene.toml:17:1: warning: [contact.nonsmooth] is not used by method 'smooth'\n");
  CHECK_THAT(problems("name = \"uic60\"", "name = \"uic61\""),
             Contains("unknown profile 'uic61'") && Contains("uic60") && Contains("scene.toml:"));
  CHECK_THAT(problems("name = \"uic60\"", "file = \"none.csv\""), Contains("there is no file"));
  CHECK_THAT(problems("mass = 1500, ", ""), Contains("mass and inertia are given together"));
  CHECK_THAT(problems("mass = 1500, inertia = [950, 120, 950]", "radius = 0.46"), Contains("radius"));
  CHECK_THAT(problems(", mass = 1500, inertia = [950, 120, 950]", ""), Contains("needs mass and inertia"));
  CHECK_THAT(problems("inertia = [950, 120, 950]", "inertia = [950, 120, 95]"), Contains("none larger than the sum"));
  CHECK_THAT(problems("fixed = true", "fixed = false"), Contains("write fixed = true"));
  CHECK_THAT(problems("normal = \"hertz\"", "normal = \"herz\""), Contains("hertz"));
  CHECK_THAT(problems("cant = \"= atan(1/40)\"", "cant = \"= atan(1/40)\", curve = { radius = 5 }"),
             Contains("at least 50 m"));
  CHECK_THAT(problems("cant = \"= atan(1/40)\"", "cant = 0.025, irregularity = { lateral = 1e-3 }"),
             Contains("one of file and wavelength"));
  CHECK_THAT(
      problems("name = \"cone\"", "name = \"cone\", flat = { length = 0.04 }, out_of_round = { amplitude = 1e-4 }"),
      Contains("one of flat and out_of_round"));
  CHECK_THAT(problems("name = \"cone\"", "name = \"cone\", flat = { angle_deg = 4 }"), Contains("needs its length"));
  CHECK_THAT(problems("body = \"wheelset\"\nspeed", "body = \"wheelsets\"\nspeed"),
             Contains("unknown body 'wheelsets'") && Contains("wheelset"));
  CHECK_THAT(problems("body = \"wheelset\"\nspeed", "body = \"track\"\nspeed"), Contains("does not move freely"));
  CHECK_THAT(problems("attachment =", "to = \"track\"\nattachment ="), Contains("leave out `to` or speed"));
  CHECK_THAT(problems("stiffness = [0, 0, 100000]", "stiffness = [0, 0, -1]"), Contains("stiffness"));
  CHECK_THAT(problems("stiffness = [0, 0, 100000]", "stifness = [0, 0, 1]"), Contains("did you mean 'stiffness'"));
  CHECK_THAT(problems("method = \"smooth\"", "method = \"nonsmooth\""), Contains("[contact.wheel_rail] is not used"));
  // a step that the creep forces cannot bear
  std::string slow = whole;
  const auto at = slow.find("time_step = ");
  slow.replace(at, slow.find('\n', at) - at, "time_step = 2e-3");
  CHECK_THROWS_WITH(start_text(slow), Contains("exceeds the limit") && Contains("wheel on rail"));
}

TEST_CASE("springs hold two bodies together with the period of their reduced mass", "[physics][springs]") {
  // omega^2 = k (1/m1 + 1/m2); a damper takes what the ledger counts
  SceneRun run = start_text(
      "[run]\nduration = 1.0\ntime_step = 1e-4\n[material.a]\ndensity = 1000\nyoungs_modulus = 1e9\npoissons_ratio = "
      "0.3\n"
      "[contact]\nmethod = \"smooth\"\nfriction = 0\nrestitution = 0\n[shape.s]\nsphere = { radius = 0.1 }\n"
      "[[body]]\nname = \"one\"\nshape = \"s\"\nmaterial = \"a\"\nvelocity = [0.1, 0, 0]\n"
      "[[body]]\nname = \"two\"\nshape = \"s\"\nmaterial = \"a\"\nposition = [1, 0, 0]\n"
      "[[spring]]\nbody = \"one\"\nto = \"two\"\nstiffness = [500, 0, 0]\n");
  Simulation& sim = run.simulation();
  const double m = 1000.0 * 4.0 / 3.0 * pi * 1e-3, omega = std::sqrt(500.0 * 2.0 / m);
  while (sim.world.time < 2.0 * pi / omega - 0.5e-4) REQUIRE_FALSE(sim.advance());
  // after a period both have moved by the mean speed, at the speeds they began with
  CHECK(sim.world.velocity[sim.world.slot_of(BodyId{0})].x() == Approx(0.1).epsilon(1e-4));
  CHECK(std::abs(sim.world.velocity[sim.world.slot_of(BodyId{1})].x()) < 1e-4 * 0.1 + 1e-5);
  CHECK(std::abs(run.energy_error()) < 1e-6);
}
