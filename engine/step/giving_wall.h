/// @file giving_wall.h  A servo wall (servo.h) in non-smooth contact. Nothing is soft there, and the forces of the last
/// step would say nothing of the next one: the wall gives way within the step, as a body of the contact problem that is
/// free along one line. The laws of servo.h, with the forces of the step itself, are both of the form
///   v = v_free + mobility * J,   J the impulse of the contacts along the direction [N s],
/// stable for every step. At most v_max, but contacts may push it back faster.
#pragma once
#include "engine/step/servo.h"

namespace epafi {

/// Speed along the direction, and how this step may change it.
struct GivingWall {
  BodyId body{};
  Servo servo;
  double speed = 0.0;    ///< [m/s]
  double missed = 0.0;   ///< integral of the force that is missing [N s]; with gains
  double impulse = 0.0;  ///< J of the last step, <= 0 [N s]
  double free_speed = 0.0;
  double mobility = 0.0;  ///< [1/kg]; 0: it rests

  /// What its force would give it from rest in this step if nothing held it [J].
  double free_energy(double dt) const { return 0.5 * mobility * (dt * servo.force) * (dt * servo.force); }
  /// Sets free_speed and mobility of the next step.
  void begin(double dt);
  /// Takes over what contacts have made of the free speed.
  void end(double solved_speed, double dt);
};

/// Prepares the wall before every step; the contact model ends the step.
class GivingWallEvent final : public Event {
 public:
  /// elapsed: of its time when the present stage began [s].
  GivingWallEvent(std::shared_ptr<GivingWall> wall, double elapsed) : wall_(std::move(wall)), elapsed_(elapsed) {}
  void before_step(World& world, double dt, std::vector<BodyId>& leaving) override;
  void visit(StateVisitor& visitor) override;

 private:
  std::shared_ptr<GivingWall> wall_;
  double elapsed_;
};

}  // namespace epafi
