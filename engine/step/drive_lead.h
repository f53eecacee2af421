/// @file drive_lead.h  Shows contacts a driven body that speeds up or slows down as they see the free ones: with its
/// velocity at the end of the step. A prescribed motion (events.h) sets that of the middle, with which the position
/// drifts; dashpots and the work of the drive would be off by dt/2 times its acceleration, at every second collision
/// with the same sign. Comes after the motion and before a servo; the position is set back before the drift by what
/// the velocity is too fast. Smooth contact with a scheme that predicts velocities only.
#pragma once
#include "engine/step/energy.h"
#include "engine/step/events.h"

namespace epafi {

class DriveLead final : public Event {
 public:
  DriveLead(BodyId body, EnergyLedger& ledger) : body_(body), ledger_(ledger) {}
  void before_step(World& world, double dt, std::vector<BodyId>& leaving) override;
  bool rests_next(const World&, double) const override { return state_.change == Vec3::Zero(); }
  bool is_local() const override { return true; }
  void visit(StateVisitor& visitor) override;

 private:
  struct State {                 // plain: one value of the checkpoint
    Vec3 middle = Vec3::Zero();  ///< velocity in the middle of the last step [m/s]
    Vec3 change = Vec3::Zero();  ///< from the step before it [m/s]
    Vec3 end = Vec3::Zero();     ///< velocity used by contacts [m/s]
  };
  BodyId body_;
  EnergyLedger& ledger_;
  State state_;
};

}  // namespace epafi
