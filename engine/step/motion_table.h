/// @file motion_table.h  A path by a table: displacement, velocity or acceleration at times that need not be
/// equidistant. Displacement: the cubic spline through the rows that rests at both ends, so that acceleration is
/// continuous inside and bounded everywhere (de Boor 1978, ch. 4). Velocity and acceleration: straight lines between
/// the rows, integrated exactly. Either way the displacement is a polynomial of degree 3 at most between two rows.
/// Before the first row and after the last the body rests; with `repeats` the table begins again from its last
/// position.
#pragma once
#include <string>
#include <vector>

#include "engine/state/types.h"

namespace epafi {

class MotionTable {
 public:
  enum class Of { displacement, velocity, acceleration };
  /// Baseline correction, subtracted from the rows. linear: a straight line, so that the body ends at its start and at
  /// rest (displacements: at its start). quadratic: a parabola, so that the mean displacement is 0 too.
  enum class Baseline { none, linear, quadratic };
  struct Rows {
    std::vector<double> time;  ///< [s], rising, two rows at least
    std::vector<Vec3> value;   ///< as many
  };

  MotionTable(Rows rows, Of of, Baseline baseline = Baseline::none, double repeats = 1.0);

  /// Displacement since the first row [m].
  Vec3 displacement(double time) const;
  /// Velocity [m/s]; at a row that of the following interval.
  Vec3 velocity(double time) const;
  double begin() const { return time_.front(); }
  double end() const { return time_.front() + repeats_ * period(); }
  /// Velocity before the last row [m/s], where the motion stops.
  Vec3 last_velocity() const;

 private:
  /// One interval: x = x0 + s (v0 + s (b + s c)), s the time since its row.
  struct Stretch {
    Vec3 x0 = Vec3::Zero(), v0 = Vec3::Zero(), b = Vec3::Zero(), c = Vec3::Zero();
    Vec3 at(double s) const { return x0 + s * (v0 + s * (b + s * c)); }
    Vec3 speed(double s) const { return v0 + s * (2.0 * b + s * (3.0 * c)); }
    Vec3 integral(double s) const { return s * (x0 + s * (v0 / 2.0 + s * (b / 3.0 + s * (c / 4.0)))); }
  };
  /// The path of some rows, and the quantities that a baseline correction sets to zero.
  struct Path {
    std::vector<Stretch> stretches;
    Vec3 end = Vec3::Zero(), speed = Vec3::Zero(), mean = Vec3::Zero();  ///< [m], [m/s], [m]
  };

  double period() const { return time_.back() - time_.front(); }
  double length(std::size_t k) const { return time_[k + 1] - time_[k]; }
  std::vector<Stretch> spline(const std::vector<Vec3>& x) const;
  Path path_through(const std::vector<Vec3>& values) const;
  void take_baseline(std::vector<Vec3>& values, Baseline baseline) const;
  /// Interval and time within it, after a number of whole tables.
  struct Found {
    std::size_t stretch;
    double since;
    double rounds;
  };
  Found find(double time) const;

  std::vector<double> time_;
  Of of_;
  double repeats_;
  Path path_;
};

}  // namespace epafi
