/// @file loads.h  Time-dependent gravity, forces and torques. They have no potential: the ledger counts their work,
/// force times displacement and torque times rotation of each step. Gravity and forces have the value of the step's
/// middle (second order). In smooth contact torques act as two half kicks, with the values at start and end of the
/// step; in non-smooth contact they enter the problem of the step.
#pragma once
#include <functional>
#include <vector>

#include "engine/state/world.h"

namespace epafi {

/// A vector at a time [s].
using TimeVector = std::function<Vec3(double)>;

/// Constant torques are loads too.
struct BodyLoad {
  BodyId body{};
  TimeVector force{}, torque{};  ///< [N], [N m], world axes; empty: none
  double elapsed = 0.0;          ///< of its time when the present stage began [s]
  Vec3 steady = Vec3::Zero();    ///< the constant part of its force [N]
};

class Loads {
 public:
  /// gravity: the time-dependent part, added to `steady`; empty: none. elapsed: its time when the stage began [s].
  struct Gravity {
    TimeVector loose{};
    Vec3 steady = Vec3::Zero();  ///< [m/s^2]
    double elapsed = 0.0;
  };
  Loads(Gravity gravity, std::vector<BodyLoad> bodies, bool kicks)
      : gravity_(std::move(gravity)), bodies_(std::move(bodies)), kicks_(kicks) {}

  /// Sets gravity, forces and torques of a time of the stage's clock [s].
  void set(World& world, double clock) const;
  /// Sets those in the middle of the step that begins now.
  void before_step(World& world, double dt);
  /// The work of the step [J].
  double after_step(World& world, double dt);

 private:
  void kick(World& world, double dt);
  void turn(World& world, double clock) const;
  Gravity gravity_;
  std::vector<BodyLoad> bodies_;
  bool kicks_;
  double kick_work_ = 0.0;          ///< of this step [J]
  Vec3 moment_ = Vec3::Zero();      ///< sum m x of the free bodies as the step began [kg m]
  std::vector<Vec3> place_, spin_;  ///< of the loaded bodies as the step began [m], [rad/s]
};

}  // namespace epafi
