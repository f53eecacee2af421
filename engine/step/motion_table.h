/// @file motion_table.h  A path by a table: displacement, velocity or acceleration at times that need not be even.
/// Displacement: the cubic spline through the rows that rests at both ends, so that acceleration is continuous inside
/// and bounded everywhere (de Boor 1978, ch. 4). Velocity and acceleration: straight lines between the rows, integrated
/// exactly. Either way the displacement is a polynomial of degree 3 at most between two rows. Before the first row the
/// body rests, behind the last it stays where it is; with `repeats` the table begins again there, from that place.
#pragma once
#include <string>
#include <vector>

#include "engine/state/types.h"

namespace epafi {

class MotionTable {
 public:
  enum class Of { displacement, velocity, acceleration };
  /// What is taken from the rows so that the path ends well. linear: a straight line, so that the body ends where it
  /// began and at rest (of a displacement: where it began). quadratic: a parabola, so that its mean displacement is 0
  /// too.
  enum class Baseline { none, linear, quadratic };
  struct Rows {
    std::vector<double> time;  ///< [s], rising, two rows at least
    std::vector<Vec3> value;   ///< as many
  };

  MotionTable(Rows rows, Of of, Baseline baseline = Baseline::none, double repeats = 1.0);

  /// Since before the first row [m].
  Vec3 displacement(double time) const;
  /// [m/s]; at a row that of the stretch behind it.
  Vec3 velocity(double time) const;
  double begin() const { return time_.front(); }
  double end() const { return time_.front() + repeats_ * period(); }
  /// At the last row [m/s]: what stops there.
  Vec3 last_velocity() const;

 private:
  /// Of one stretch: x = x0 + s (v0 + s (b + s c)), s the time since its row.
  struct Stretch {
    Vec3 x0 = Vec3::Zero(), v0 = Vec3::Zero(), b = Vec3::Zero(), c = Vec3::Zero();
    Vec3 at(double s) const { return x0 + s * (v0 + s * (b + s * c)); }
    Vec3 speed(double s) const { return v0 + s * (2.0 * b + s * (3.0 * c)); }
    Vec3 integral(double s) const { return s * (x0 + s * (v0 / 2.0 + s * (b / 3.0 + s * (c / 4.0)))); }
  };
  /// The path through some rows, and the quantities that a baseline sets to zero.
  struct Path {
    std::vector<Stretch> stretches;
    Vec3 end = Vec3::Zero(), speed = Vec3::Zero(), mean = Vec3::Zero();  ///< [m], [m/s], [m]
  };

  double period() const { return time_.back() - time_.front(); }
  double length(std::size_t k) const { return time_[k + 1] - time_[k]; }
  std::vector<Stretch> spline(const std::vector<Vec3>& x) const;
  Path path_through(const std::vector<Vec3>& values) const;
  void take_baseline(std::vector<Vec3>& values, Baseline baseline) const;
  /// Stretch and time within it, after so many whole tables.
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
