/// @file servo_event.h  A servo wall (servo.h) in smooth contact. Its law takes the forces of the last detection, so
/// that the wall is a leapfrog beside velocity Verlet: it drifts with the speed of the middle of the step. Contacts see
/// it as they see the bodies, at the end of the step: world.velocity is the end's, predicted by the last acceleration,
/// and the position is set back before the drift by what that is too fast. Dashpots that see the middle's speed book
/// losses off by dt/2 times their force times the change of speed, up to 0.27 of all energy under light walls.
#pragma once
#include "engine/step/energy.h"
#include "engine/step/servo.h"

namespace epafi {

class ServoEvent final : public Event {
 public:
  /// elapsed: of its time when the present stage began [s]. ledger: takes what the wall's work is beyond that of
  /// world.velocity.
  ServoEvent(BodyId body, const Servo& servo, double elapsed, EnergyLedger& ledger)
      : body_(body), servo_(servo), elapsed_(elapsed), ledger_(ledger) {}
  void before_step(World& world, double dt, std::vector<BodyId>& leaving) override;
  /// Every process knows the sum of all forces on the wall (engine/state/held_loads.h).
  bool is_local() const override { return true; }
  void visit(StateVisitor& visitor) override;

 private:
  double next_speed(double push, double dt);

  BodyId body_;
  Servo servo_;
  double elapsed_;
  EnergyLedger& ledger_;
  double speed_ = 0.0;   ///< along the direction, in the middle of the step [m/s]
  double ahead_ = 0.0;   ///< half a step times what world.velocity is faster [m]
  double missed_ = 0.0;  ///< integral of the force that is missing [N s]; with gains
};

}  // namespace epafi
