// Ways by tables: closed forms of what passes through the rows, integrals by fine sums, drift taken out.
#include <cmath>
#include <numbers>

#include "engine/step/motion_table.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

using Of = MotionTable::Of;
using Baseline = MotionTable::Baseline;

/// Uneven times from 0.3 s on, three components by chance.
MotionTable::Rows rows_by_chance(std::uint64_t seed, std::size_t count) {
  Random random(seed, 0);
  MotionTable::Rows rows;
  double t = 0.3;
  for (std::size_t k = 0; k < count; ++k) {
    rows.time.push_back(t);
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    rows.value.emplace_back(x, y, z);
    t += random.uniform(0.005, 0.05);
  }
  return rows;
}

Vec3 between(const MotionTable::Rows& rows, double t) {
  std::size_t k = 0;
  while (k + 2 < rows.time.size() && rows.time[k + 1] <= t) ++k;
  const double share = (t - rows.time[k]) / (rows.time[k + 1] - rows.time[k]);
  return rows.value[k] + share * (rows.value[k + 1] - rows.value[k]);
}

}  // namespace

TEST_CASE("displacement passes through its rows and rests at both ends", "[engine][motion]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto rows = rows_by_chance(seed, 3 + seed);
    const MotionTable table(rows, Of::displacement);
    for (std::size_t k = 0; k < rows.time.size(); ++k)
      CHECK((table.displacement(rows.time[k]) - (rows.value[k] - rows.value[0])).norm() < 1e-13);
    CHECK(table.velocity(rows.time.front()).norm() < 1e-11);
    CHECK(table.last_velocity().norm() < 1e-11);
    CHECK(table.displacement(0.0).isZero(0.0));
    CHECK((table.displacement(1e3) - (rows.value.back() - rows.value[0])).norm() < 1e-13);
    for (std::size_t k = 1; k + 1 < rows.time.size(); ++k) {  // velocity goes on from stretch to stretch
      const double h = 1e-9;
      CHECK((table.velocity(rows.time[k] + h) - table.velocity(rows.time[k] - h)).norm() < 1e-3);
    }
  }
}

TEST_CASE("the spline through samples of a smooth way has an error of fourth order", "[engine][motion]") {
  // x = 1 - cos(2 pi t) rests at t = 0 and 1; the clamped cubic spline errs by 5/384 h^4 max|x''''| (de Boor 1978)
  for (const int n : {20, 40, 80}) {
    MotionTable::Rows rows;
    for (int k = 0; k <= n; ++k) {
      const double t = static_cast<double>(k) / n;
      rows.time.push_back(t);
      rows.value.emplace_back(1 - std::cos(2 * std::numbers::pi * t), 0, 0);
    }
    const MotionTable table(rows, Of::displacement);
    const double bound = 5.0 / 384 * std::pow(1.0 / n, 4) * std::pow(2 * std::numbers::pi, 4);
    double worst = 0.0;
    for (double t = 0; t < 1; t += 1e-3)
      worst = std::max(worst, std::abs(table.displacement(t).x() - (1 - std::cos(2 * std::numbers::pi * t))));
    CHECK(worst < 1.01 * bound);
    CHECK(worst > 0.1 * bound);
  }
}

TEST_CASE("velocity and acceleration are integrated exactly", "[engine][motion]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto rows = rows_by_chance(seed, 40);
    const MotionTable by_speed(rows, Of::velocity), by_acceleration(rows, Of::acceleration);
    // straight lines: Simpson's rule is exact on each stretch, for the square terms of the second integral too
    Vec3 x = Vec3::Zero(), v = Vec3::Zero(), y = Vec3::Zero();
    for (std::size_t k = 0; k + 1 < rows.time.size(); ++k) {
      const double h = rows.time[k + 1] - rows.time[k];
      const Vec3 a = rows.value[k], b = rows.value[k + 1];
      x += 0.5 * h * (a + b);
      y += h * v + h * h * (a / 3.0 + b / 6.0);
      v += 0.5 * h * (a + b);
      CHECK((by_speed.displacement(rows.time[k + 1]) - x).norm() < 1e-13);
      CHECK((by_acceleration.displacement(rows.time[k + 1]) - y).norm() < 1e-13);
      const double middle = rows.time[k] + 0.37 * h;
      CHECK((by_speed.velocity(middle) - between(rows, middle)).norm() < 1e-13);
    }
  }
}

TEST_CASE("a baseline takes the drift out, and out of nothing else", "[engine][motion]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto rows = rows_by_chance(seed, 60);
    for (const Of of : {Of::displacement, Of::velocity, Of::acceleration})
      for (const Baseline baseline : {Baseline::linear, Baseline::quadratic}) {
        const MotionTable table(rows, of, baseline);
        CHECK(table.displacement(table.end()).norm() < 1e-12);
        CHECK(table.last_velocity().norm() < 1e-11);
        if (baseline != Baseline::quadratic) continue;
        Vec3 mean = Vec3::Zero();  // by the midpoint rule: 2e4 parts of a way with |x''| < 1e3
        const int parts = 20000;
        for (int k = 0; k < parts; ++k)
          mean += table.displacement(table.begin() + (k + 0.5) / parts * (table.end() - table.begin())) / parts;
        CHECK(mean.norm() < 1e-6);
      }
  }
  // a way that needs none is left alone: sin over whole periods in acceleration ends with the drift of its start
  const auto rows = rows_by_chance(3, 30);
  const MotionTable once(rows, Of::acceleration, Baseline::linear);
  MotionTable::Rows clean = rows;
  for (std::size_t k = 0; k < clean.time.size(); ++k) clean.value[k] *= 2.0;
  const MotionTable twice(clean, Of::acceleration, Baseline::linear);
  for (double t = 0.3; t < once.end(); t += 0.01)
    CHECK((twice.displacement(t) - 2.0 * once.displacement(t)).norm() < 1e-12);
}

TEST_CASE("a table that repeats goes on from where it ended", "[engine][motion]") {
  const auto rows = rows_by_chance(7, 12);
  const MotionTable one(rows, Of::displacement), many(rows, Of::displacement, Baseline::none, 3);
  const double period = rows.time.back() - rows.time.front();
  const Vec3 way = one.displacement(rows.time.back());
  for (const double u : {0.01, 0.3, 0.77}) {
    const double t = rows.time.front() + u * period;
    CHECK((many.displacement(t + 2 * period) - (one.displacement(t) + 2 * way)).norm() < 1e-12);
  }
  CHECK((many.displacement(1e3) - 3 * way).norm() < 1e-12);
}
