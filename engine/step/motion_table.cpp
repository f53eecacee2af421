#include "engine/step/motion_table.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "engine/units/error.h"

namespace epafi {

MotionTable::MotionTable(Rows rows, Of of, Baseline baseline, double repeats)
    : time_(std::move(rows.time)), of_(of), repeats_(repeats) {
  EPAFI_REQUIRE(time_.size() >= 2 && time_.size() == rows.value.size(), "a table has two rows at least");
  if (baseline != Baseline::none) take_baseline(rows.value, baseline);
  path_ = path_through(rows.value);
}

/// Clamped: first derivative 0 at both ends. Thomas' algorithm for the second derivatives.
std::vector<MotionTable::Stretch> MotionTable::spline(const std::vector<Vec3>& x) const {
  const std::size_t n = x.size();
  std::vector<double> upper(n, 0.0);
  std::vector<Vec3> m(n);
  const auto slope = [&](std::size_t k) { return Vec3((x[k + 1] - x[k]) / length(k)); };
  for (std::size_t k = 0; k < n; ++k) {
    const double before = k > 0 ? length(k - 1) : 0.0, after = k + 1 < n ? length(k) : 0.0;
    const Vec3 left = k > 0 ? slope(k - 1) : Vec3(Vec3::Zero()), right = k + 1 < n ? slope(k) : Vec3(Vec3::Zero());
    const double pivot = 2.0 * (before + after) - before * (k > 0 ? upper[k - 1] : 0.0);
    upper[k] = after / pivot;
    m[k] = (6.0 * (right - left) - before * (k > 0 ? m[k - 1] : Vec3(Vec3::Zero()))) / pivot;
  }
  for (std::size_t k = n - 1; k-- > 0;) m[k] -= upper[k] * m[k + 1];
  std::vector<Stretch> out(n - 1);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    const double h = length(k);
    out[k] = {x[k], slope(k) - h / 6.0 * (2.0 * m[k] + m[k + 1]), 0.5 * m[k], (m[k + 1] - m[k]) / (6.0 * h)};
  }
  return out;
}

MotionTable::Path MotionTable::path_through(const std::vector<Vec3>& values) const {
  Path path;
  if (of_ == Of::displacement) {
    std::vector<Vec3> from_rest = values;
    for (Vec3& x : from_rest) x -= values.front();
    path.stretches = spline(from_rest);
  } else {
    Vec3 x = Vec3::Zero(), v = of_ == Of::velocity ? values.front() : Vec3(Vec3::Zero());
    for (std::size_t k = 0; k + 1 < values.size(); ++k) {
      const double h = length(k);
      const Vec3 rise = (values[k + 1] - values[k]) / h;
      const Stretch s = of_ == Of::velocity ? Stretch{x, values[k], 0.5 * rise, Vec3::Zero()}
                                            : Stretch{x, v, 0.5 * values[k], rise / 6.0};
      x = s.at(h);
      v = s.speed(h);
      path.stretches.push_back(s);
    }
  }
  for (std::size_t k = 0; k < path.stretches.size(); ++k) path.mean += path.stretches[k].integral(length(k)) / period();
  const double last = length(path.stretches.size() - 1);
  path.end = path.stretches.back().at(last);
  path.speed = path.stretches.back().speed(last);
  return path;
}

/// The path is linear in the rows: the shares of the powers of time are those with which end, speed and mean vanish.
void MotionTable::take_baseline(std::vector<Vec3>& values, Baseline baseline) const {
  const bool rests = of_ == Of::displacement;  // both ends of a displacement are at rest anyhow
  const int unknowns = (baseline == Baseline::linear ? 2 : 3) - (rests ? 1 : 0);
  const auto conditions = [&](const Path& path, int component) {
    Eigen::VectorXd c(unknowns);
    int row = 0;
    c[row++] = path.end[component];
    if (!rests) c[row++] = path.speed[component];
    if (row < unknowns) c[row] = path.mean[component];
    return c;
  };
  const auto power = [&](std::size_t k, int p) { return std::pow((time_[k] - time_.front()) / period(), p); };
  std::vector<int> powers;
  for (int p = rests ? 1 : 0; static_cast<int>(powers.size()) < unknowns; ++p) powers.push_back(p);
  Eigen::MatrixXd influence(unknowns, unknowns);
  for (int j = 0; j < unknowns; ++j) {
    std::vector<Vec3> rows(values.size());
    for (std::size_t k = 0; k < rows.size(); ++k)
      rows[k] = Vec3::Constant(power(k, powers[static_cast<std::size_t>(j)]));
    influence.col(j) = conditions(path_through(rows), 0);
  }
  const Path raw = path_through(values);
  const auto solver = influence.fullPivLu();
  for (int component = 0; component < 3; ++component) {
    const Eigen::VectorXd share = solver.solve(conditions(raw, component));
    for (std::size_t k = 0; k < values.size(); ++k)
      for (int j = 0; j < unknowns; ++j)
        values[k][component] -= share[j] * power(k, powers[static_cast<std::size_t>(j)]);
  }
}

MotionTable::Found MotionTable::find(double time) const {
  double since = time - time_.front();
  const double rounds = repeats_ > 1.0 ? std::min(std::floor(since / period()), repeats_ - 1.0) : 0.0;
  since -= rounds * period();
  const double inside = time_.front() + since;
  const auto after = std::upper_bound(time_.begin(), time_.end(), inside);
  const auto row = std::clamp<std::ptrdiff_t>(after - time_.begin() - 1, 0, std::ssize(time_) - 2);
  const auto k = static_cast<std::size_t>(row);
  return {k, std::min(inside, time_.back()) - time_[k], rounds};
}

Vec3 MotionTable::displacement(double time) const {
  if (time <= begin()) return Vec3::Zero();
  const Found f = find(time);
  return path_.stretches[f.stretch].at(f.since) + f.rounds * path_.end;
}

Vec3 MotionTable::velocity(double time) const {
  if (time < begin() || time >= end()) return Vec3::Zero();
  const Found f = find(time);
  return path_.stretches[f.stretch].speed(f.since);
}

Vec3 MotionTable::last_velocity() const { return path_.speed; }

}  // namespace epafi
