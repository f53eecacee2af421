/// @file nonsmooth_servo.h  A servo wall (servo.h) in non-smooth contact. Contacts are rigid there, so the forces of
/// the last step do not predict the next ones. The wall is therefore an unknown of the contact problem, free along one
/// line. Both laws of servo.h, with the forces of the step itself, have the form v = v_free + mobility * J, J the
/// impulse of the contacts along the direction [N s], stable for every step. The wall approaches at v_max at most;
/// contacts may push it back faster.
#pragma once
#include "engine/step/servo.h"

namespace epafi {

/// Speed along the direction, and its law in this step.
struct NonsmoothServo {
  BodyId body{};
  Servo servo;
  double speed = 0.0;    ///< [m/s]
  double missed = 0.0;   ///< integral of F - F_contact [N s]; with gains
  double impulse = 0.0;  ///< J of the last step, <= 0 [N s]
  double free_speed = 0.0;
  double mobility = 0.0;  ///< [1/kg]; 0: it rests

  /// Energy that the force gives the wall from rest in this step without contacts [J].
  double free_energy(double dt) const { return 0.5 * mobility * (dt * servo.force) * (dt * servo.force); }
  /// Computes free_speed and mobility of the next step.
  void begin(double dt);
  /// Takes the speed that results from the contacts.
  void end(double solved_speed, double dt);
};

/// Prepares the wall before every step; the contact model ends the step.
class NonsmoothServoEvent final : public Event {
 public:
  /// elapsed: of its time when the present stage began [s].
  NonsmoothServoEvent(std::shared_ptr<NonsmoothServo> wall, double elapsed)
      : wall_(std::move(wall)), elapsed_(elapsed) {}
  void before_step(World& world, double dt, std::vector<BodyId>& leaving) override;
  void visit(StateVisitor& visitor) override;

 private:
  std::shared_ptr<NonsmoothServo> wall_;
  double elapsed_;
};

}  // namespace epafi
