// Library scenes in stages, shortened: the figure that each of them states at its head.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <random>

#include <fmt/format.h>

#include "scenes/session.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/hdf5/stored_run.h"

using namespace epafi;
using namespace epafi::experiments;
namespace fs = std::filesystem;

namespace {

struct Sample {
  double time = 0.0, value = 0.0;
};

/// A scene of the library, run in all its stages, and what its file holds.
struct StagedRun {
  TemporaryFolder folder;
  Ending ending = Ending::completed;
  RunSummary summary;
  std::unique_ptr<StoredRun> stored;

  StagedRun(const std::string& scene, const std::vector<std::string>& overrides) {
    ReadResult read = read_scene(library("stages/" + scene), overrides, full_registry());
    for (const Problem& p : read.problems) UNSCOPED_INFO(p.to_string());
    REQUIRE(read.scene);
    {
      Session session(assemble(std::move(*read.scene)), overrides, folder / "out");
      ending = session.run({}, true);
      summary = session.summary();
    }
    stored = std::make_unique<StoredRun>(folder / "out" / "run.h5");
  }

  std::vector<Sample> series(const std::string& measure, const std::string& component) const {
    std::vector<Sample> out;
    for (const StoredMeasure& m : stored->measures()) {
      if (m.name != measure) continue;
      const auto at = std::ranges::find(m.components, component) - m.components.begin();
      for (std::size_t k = 0; k < m.times.size(); ++k)
        out.push_back({m.times[k], m.values[k * m.components.size() + static_cast<std::size_t>(at)]});
    }
    REQUIRE(!out.empty());
    return out;
  }
  std::vector<BodyRecord> bodies(std::size_t frame) const { return stored->snapshot(frame).bodies; }
  std::size_t last_frame() const { return stored->snapshots() - 1; }
};

/// By straight lines.
double value_at(const std::vector<Sample>& series, double time) {
  std::size_t k = 1;
  while (k + 1 < series.size() && series[k].time < time) ++k;
  const Sample &a = series[k - 1], &b = series[k];
  return a.value + (b.value - a.value) * (time - a.time) / (b.time - a.time);
}

double integral(const std::vector<Sample>& series, double from, double until) {
  double sum = 0.0;
  for (std::size_t k = 1; k < series.size(); ++k)
    if (series[k - 1].time >= from && series[k].time <= until)
      sum += 0.5 * (series[k].value + series[k - 1].value) * (series[k].time - series[k - 1].time);
  return sum;
}

}  // namespace

TEST_CASE("a drum's power is the moment of its grains' weight, and none where they turn with it", "[scenes][stages]") {
  // softer grains: steps four times longer
  StagedRun run("drum.toml", {"material.grain.youngs_modulus=1e5", "run.time_step=1.6e-4", "params.time=0.5"});
  REQUIRE(run.ending == Ending::completed);
  const auto x = run.series("centre", "x"), work = run.series("energy", "work");
  double mass = 0.0, momentum = 0.0, inertia = 0.0;
  for (const BodyRecord& b : run.bodies(run.last_frame())) {
    const Vec3 &p = b.pose.position, &v = b.velocity;
    mass += b.mass;
    momentum += b.mass * (p.z() * v.x() - p.x() * v.z());
    inertia += b.mass * (p.x() * p.x() + p.z() * p.z());
  }
  // dL/dt = M - m g x: over the second half of the slow stage what the drum gives is w m g times the integral of x; the
  // grains' own momentum, at most m w R^2, and the balls' spin are small beside it
  const auto slow = run.summary.stages.at(1);
  const double begin = 0.5 * (slow.from + slow.until), end = slow.until, rate = 2.0;
  const double given = value_at(work, end) - value_at(work, begin);
  const double lifted = std::abs(integral(x, begin, end)) * rate * mass * 9.81;
  CHECK(given == Approx(lifted).epsilon(0.1));
  CHECK(given > 0.1 * mass * 9.81 * 0.05 * rate * (end - begin));  // the slope is there: x is a tenth of R at least
  // w^2 R/g = 4: gravity never takes a grain off the wall. The inner layers slide until friction has brought them to
  // the drum's speed; they are never faster.
  CHECK(std::abs(momentum / inertia) > 0.85 * 28.0);
  CHECK(std::abs(momentum / inertia) < 1.01 * 28.0);
}

namespace {

/// Rows of the record in m/s^2, and its step [s].
std::vector<Vec3> record_rows() {
  std::ifstream in(library("stages/record.csv"));
  std::vector<Vec3> rows;
  for (std::string line; std::getline(in, line);) {
    double t = 0, x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &t, &x, &y, &z) == 4) rows.push_back(1e-3 * Vec3(x, y, z));
  }
  return rows;
}

/// Place after each row of an acceleration that is straight between its rows.
std::vector<long double> twice_integrated(const std::vector<long double>& a, long double h) {
  std::vector<long double> x(a.size(), 0.0L);
  long double v = 0.0L;
  for (std::size_t k = 0; k + 1 < a.size(); ++k) {
    x[k + 1] = x[k] + h * v + h * h * (a[k] / 3.0L + a[k + 1] / 6.0L);
    v += 0.5L * h * (a[k] + a[k + 1]);
  }
  x.push_back(v);  // the last speed stands behind
  return x;
}

using Conditions = std::array<long double, 3>;

/// End, speed and mean of the way of rows of acceleration. A stretch has the mean
/// h/2 (x_k + x_k+1) - h^3/24 (a_k + a_k+1).
Conditions conditions_of(const std::vector<long double>& a, long double h) {
  const auto x = twice_integrated(a, h);
  const std::size_t n = a.size();
  long double mean = 0.0L;
  for (std::size_t k = 0; k + 1 < n; ++k) mean += 0.5L * h * (x[k] + x[k + 1]) - h * h * h / 24.0L * (a[k] + a[k + 1]);
  return {x[n - 1], x[n], mean};
}

long double determinant_of(const std::array<Conditions, 3>& c) {
  return c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[2][1]) - c[1][0] * (c[0][1] * c[2][2] - c[0][2] * c[2][1]) +
         c[2][0] * (c[0][1] * c[1][2] - c[0][2] * c[1][1]);
}

/// A table that follows the record of the library, alone.
SceneRun table_run() {
  ReadResult read = read_scene_text(
      "[run]\nduration = 41\ntime_step = 0.01\noutput_interval = 0.4\n[material.m]\ndensity = 2000.0\n"
      "[contact]\nmethod = \"nonsmooth\"\nrestitution = 0.0\nfriction = 0.0\n"
      "[[body]]\nname = \"table\"\nmaterial = \"m\"\nshape = { box = { size = [1, 1, 1] } }\n"
      "motion = { file = \"record.csv\", of = \"acceleration\", unit = \"mm/s^2\", baseline = \"quadratic\" }\n",
      library("stages/scene.toml"), {}, full_registry());
  for (const Problem& p : read.problems) UNSCOPED_INFO(p.to_string());
  return prepare(std::move(read));
}

}  // namespace

TEST_CASE("the table under the wall follows the integral of its record to 1e-9 m", "[scenes][stages]") {
  // The baseline takes a parabola off the rows so that end, speed and mean of the way vanish: Cramer's rule on the ways
  // of 1, s and s^2.
  const long double h = 0.02L;
  const auto rows = record_rows();
  REQUIRE(rows.size() == 2001);
  const std::size_t n = rows.size();
  std::array<std::vector<long double>, 3> power;
  for (int p = 0; p < 3; ++p)
    for (std::size_t k = 0; k < n; ++k)
      power[static_cast<std::size_t>(p)].push_back(std::pow(static_cast<long double>(k) / (n - 1.0L), p));
  std::array<Conditions, 3> m;
  for (std::size_t p = 0; p < 3; ++p) m[p] = conditions_of(power[p], h);
  SceneRun run = table_run();
  run.simulation().start();
  std::array<std::vector<long double>, 3> way;
  for (int c = 0; c < 3; ++c) {
    std::vector<long double> a;
    for (const Vec3& row : rows) a.push_back(row[c]);
    const Conditions raw = conditions_of(a, h);
    for (std::size_t p = 0; p < 3; ++p) {
      auto replaced = m;
      replaced[p] = raw;
      const long double share = determinant_of(replaced) / determinant_of(m);
      for (std::size_t k = 0; k < n; ++k) a[k] -= share * power[p][k];
    }
    way[static_cast<std::size_t>(c)] = twice_integrated(a, h);
  }
  double worst = 0.0, largest = 0.0;
  for (std::size_t k = 1; k < n; ++k) {
    run.advance_to(2 * k);
    for (int c = 0; c < 3; ++c) {
      const auto exact = static_cast<double>(way[static_cast<std::size_t>(c)][k]);
      worst = std::max(worst, std::abs(run.simulation().world.position[0][c] - exact));
      largest = std::max(largest, std::abs(exact));
    }
  }
  CHECK(worst < 1e-9);
  CHECK(largest > 0.01);
  CHECK(run.simulation().world.position[0].norm() < 1e-9);  // it ends where it began
}

TEST_CASE("a wall stays on its table below the acceleration that rocks it", "[scenes][stages]") {
  // to the third second of strong motion
  StagedRun stands("wall.toml", {"params.record=5", "run.time_step=1e-2", "run.output_interval=1"});
  REQUIRE(stands.ending == Ending::completed);
  const auto first = stands.bodies(0), last = stands.bodies(stands.last_frame());
  REQUIRE(last.size() == 37);
  const Vec3 table = last[0].pose.position - first[0].pose.position;
  CHECK(table.norm() > 1e-3);
  // stones take the table's speed with the impulses of a step, so they lag by a part of its way over that step
  const double lag = 1e-2 * last[0].velocity.norm();
  const Vec3 stone = last[1].pose.position - first[1].pose.position;
  CHECK((stone - table).norm() < lag + 1e-5);
  for (std::size_t k = 2; k < last.size(); ++k)
    CHECK((last[k].pose.position - first[k].pose.position - stone).norm() < 1e-5);
}

TEST_CASE("a driven wheelset gains the speed of rolling without slip", "[scenes][stages]") {
  StagedRun run("wheelset.toml", {"params.drive=0.2", "params.coast=0.05"});
  REQUIRE(run.ending == Ending::completed);
  CHECK(run.summary.warnings.empty());
  const auto distance = run.series("run", "distance");
  const auto driven = run.summary.stages.at(1);
  const double r = 0.46, gain = 1200 / (r * (1500 + 120 / (r * r)));
  // it begins at rest: the same law for way and speed
  CHECK(value_at(distance, driven.until) - value_at(distance, driven.from) == Approx(0.5 * gain * 0.04).epsilon(0.01));
}

TEST_CASE("a servo plate clamps a pile with its force, which wall and floor give back", "[scenes][stages]") {
  StagedRun run("clamp.toml", {});
  REQUIRE(run.ending == Ending::completed);
  CHECK(run.summary.warnings.empty());
  const std::array<double, 3> force{400.0, 1200.0, 200.0};
  const double weight = 5 * 2000.0 * 1e-3 * 9.81;
  REQUIRE(run.summary.stages.size() == force.size());
  for (std::size_t k = 0; k < force.size(); ++k) {
    INFO(k);
    const double end = run.summary.stages[k].until;
    const auto at_end = [&](const char* body, const char* axis) { return value_at(run.series(body, axis), end); };
    CHECK(at_end("plate", "x") == Approx(-force[k]).epsilon(1e-6));
    CHECK(at_end("wall", "x") + at_end("floor", "x") == Approx(force[k]).epsilon(1e-5));
    CHECK(at_end("plate", "y") + at_end("wall", "y") + at_end("floor", "y") == Approx(0.0).margin(1e-3));
    CHECK(at_end("plate", "z") + at_end("wall", "z") + at_end("floor", "z") == Approx(-weight).epsilon(1e-5));
  }
}

TEST_CASE("bodies_removed counts what stages, times and the domain take out, free or fixed", "[scenes][stages]") {
  std::mt19937 random(8);
  std::uniform_int_distribution<int> some(0, 3);
  for (int trial = 0; trial < 8; ++trial) {
    const int free = some(random), fixed = some(random), timed = some(random), leaving = 1 + some(random);
    const auto bodies = [](const char* name, int count, double height, const std::string& more) {
      return count == 0 ? std::string()
                        : fmt::format(
                              "[[body]]\nname = \"{}\"\nrepeat = {}\nshape = {{ sphere = {{ radius = 0.01 }} }}\n"
                              "material = \"m\"\nposition = [\"= 0.1*i\", 0, {}]\n{}",
                              name, count, height, more);
    };
    std::string taken;
    if (free > 0) taken += "body.free = { remove = true }\n";
    if (fixed > 0) taken += "body.fixed = { remove = true }\n";
    const std::string text =
        "[run]\noutput_interval = 0.01\n[world]\ndomain = { min = [-1, -1, -1], max = [1, 1, 1], "
        "outside = \"delete\" }\n[contact]\nmethod = \"smooth\"\nrestitution = 1\nfriction = 0\n[material.m]\n"
        "density = 1000\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n" +
        bodies("free", free, 0.1, "") + bodies("fixed", fixed, 0.2, "fixed = true\n") +
        bodies("timed", timed, 0.3, "fixed = true\nremove_at = 0.005\n") +
        bodies("leaving", leaving, 0.9, "velocity = [0, 0, 20]\n") + bodies("staying", 2, -0.5, "") +
        "[[stage]]\nname = \"a\"\nduration = 0.02\n[[stage]]\nname = \"b\"\nduration = 0.2\n" + taken;
    INFO(text);
    const TemporaryFolder folder;
    ReadResult read = read_scene_text(text, "scene.toml", {}, full_registry());
    REQUIRE(read.scene);
    Session session(assemble(std::move(*read.scene)), {}, folder / "out");
    REQUIRE(session.run({}, true) == Ending::completed);
    const RunSummary summary = session.summary();
    CHECK(summary.bodies_removed == static_cast<std::uint64_t>(free + fixed + timed + leaving));
    CHECK(summary.bodies_lost == 0);
  }
}

TEST_CASE("a servo with a force alone presses along gravity with its body's own mass", "[scenes][stages]") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> force(5.0, 50.0), size(0.05, 0.1);
  for (int trial = 0; trial < 6; ++trial) {
    const double F = force(random), s = size(random), r = 0.02, g = 9.81;
    const auto scene = [&](const std::string& servo) {
      return fmt::format(
          "[run]\nduration = 0.6\noutput_interval = 0.1\n[world]\ngravity = [0, 0, -9.81]\n[contact]\n"
          "method = \"{}\"\nrestitution = 0.2\nfriction = 0.3\n[material.m]\ndensity = 2000\n"
          "youngs_modulus = 1e7\npoissons_ratio = 0.3\n[[body]]\nname = \"floor\"\nfixed = true\nmaterial = \"m\"\n"
          "shape = {{ half_space = {{ normal = [0, 0, 1] }} }}\n[[body]]\nname = \"ball\"\nmaterial = \"m\"\n"
          "shape = {{ sphere = {{ radius = {} }} }}\nposition = [0, 0, {}]\n[[body]]\nname = \"plate\"\n"
          "material = \"m\"\nshape = {{ box = {{ size = [{}, {}, 0.02] }} }}\nposition = [0, 0, {}]\n"
          "motion = {{ servo = {{ force = {}{} }} }}\n[[measure]]\nname = \"floor\"\nkind = \"force\"\n"
          "body = \"floor\"\n[[measure]]\nname = \"plate\"\nkind = \"position\"\nbody = \"plate\"\n",
          trial % 2 ? "nonsmooth" : "smooth", r, r, s, s, 2 * r + 0.0101, F, servo);
    };
    const double mass = 2000 * s * s * 0.02;
    auto bare = start_text(scene("")),
         written = start_text(scene(fmt::format(", direction = [0, 0, -1], mass = {:.17g}, max_speed = "
                                                "{:.17g}",
                                                mass, std::sqrt(F * 2 * r / mass))));
    bare.advance_to(0);
    written.advance_to(0);
    INFO(F << " N, " << s << " m");
    CHECK(bare.failure.empty());
    CHECK(bare.last("plate", "z") == Approx(written.last("plate", "z")).epsilon(1e-9));  // masses differ by rounding
    CHECK(bare.last("floor", "z") == Approx(written.last("floor", "z")).epsilon(1e-6));
    const double weight = 4.0 / 3.0 * std::numbers::pi * r * r * r * 2000 * g;
    CHECK(-bare.last("floor", "z") == Approx(F + weight).epsilon(0.01));  // it has come to rest
  }
  const std::string still =
      "[run]\nduration = 1\n[contact]\nmethod = \"smooth\"\nrestitution = 0\nfriction = 0\n"
      "[material.m]\ndensity = 1\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n[[body]]\n"
      "name = \"plate\"\nmaterial = \"m\"\nmotion = { servo = { force = 1 } }\n";
  CHECK_THROWS_WITH(start_text(still + "shape = { sphere = { radius = 1 } }\n"), Catch::Contains("write direction"));
  CHECK_THROWS_WITH(start_text(still + "shape = { half_space = { normal = [0, 0, 1] } }\n[world]\n"
                                       "gravity = [0, 0, -1]\n"),
                    Catch::Contains("write mass"));
}
