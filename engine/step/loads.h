/// @file loads.h  Gravity, forces and torques that follow time. What follows time has no potential: its work is booked,
/// force times way and torque times turn of each step.
/// Gravity and forces hold the value of the step's middle through the step: of second order. Torques of smooth contact
/// kick half a step before and half after, each with the value of its moment; those of non-smooth contact enter the
/// problem of the step.
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
  /// gravity: its part that follows time, beside `steady`; empty: none. elapsed: of its time when the stage began [s].
  struct Gravity {
    TimeVector loose{};
    Vec3 steady = Vec3::Zero();  ///< [m/s^2]
    double elapsed = 0.0;
  };
  Loads(Gravity gravity, std::vector<BodyLoad> bodies, bool kicks)
      : gravity_(std::move(gravity)), bodies_(std::move(bodies)), kicks_(kicks) {}

  /// Gravity, forces and torques of a moment of the stage's clock [s].
  void set(World& world, double clock) const;
  /// Sets those of the middle of the step that begins now.
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
