/// @file smooth_contact.h  The loop of smooth contact: forces of all contacts by the parts of one law, then sums by
/// body. Dampers use velocities at the time of the detection (StepClock::velocity_lag), predicted with the stored
/// acceleration; springs use the displacement over the step, the velocity in its middle times dt. Both are second order
/// with velocity Verlet.
///
/// Energies (StepReport): viscous losses and work of driven bodies by the trapezoid of their power; losses of springs
/// (slip, rescaling, opening of the contact) as work done on them minus growth of their energy.
#pragma once
#include "engine/state/incidence.h"
#include "engine/step/pipeline.h"
#include "laws/smooth/record_memory.h"
#include "laws/smooth/smooth_law.h"

namespace epafi {

/// Sums over contacts, of one block and of all.
struct SmoothSums {
  std::size_t touching = 0;
  double elastic = 0.0;        ///< of the normal parts [J]
  double spring_energy = 0.0;  ///< of the friction and rolling springs [J]
  double spring_work = 0.0;    ///< done on the springs during the step [J]
  double viscous_power = 0.0;  ///< lost in dampers now [W]
  double late = 0.0;           ///< as DashpotLoss::late [J]
  double driven_power = 0.0;   ///< of driven bodies on the others now [W]
  double lost = 0.0;           ///< to plastic deformation and adhesion during the step [J]

  SmoothSums& operator+=(const SmoothSums& o);
};

/// Change of the velocities between the middle of the step and the detection, by slot.
struct VelocityChange {
  std::vector<Vec3> linear, angular;
  /// time: lag dt [s], which multiplies the stored acceleration; 0: not needed.
  void predict(const World& world, double time);
  /// Only of the bodies that have contacts, which are found here.
  void predict(const World& world, const ContactSet& contacts, TouchedBodies& touched, double time);

 private:
  void resize(const World& world) {
    linear.resize(world.size());
    angular.resize(world.rotates() ? world.size() : 0);
  }
  void of(const World& world, Slot body, double time);
};

/// Force on A times branch, by axis [N m]: the virial of a periodic cell, whose bits depend on the contacts alone; of
/// several processes of those that this one counts.
Vec3 contact_virial(const World& world, const ContactSet& contacts);

class SmoothContact final : public ContactModel {
 public:
  explicit SmoothContact(SmoothLaw law);

  const char* name() const override { return "smooth"; }
  void act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) override;
  void reorder(const Reordering& change) override;
  void visit(StateVisitor& visitor) override;

 private:
  /// One call of act().
  struct Call {
    const World& world;
    ContactSet& contacts;
    double dt, lag;
    bool rotates;
    double before;  ///< as DamperStep::before
  };
  /// A contact that touches, as the parts below share it.
  struct Touch {
    std::size_t i;
    Slot a, b;
    std::size_t pair;      ///< of materials
    Vec3 branch;           ///< from the centre of A to that of B [m]
    Vec3 arm_b;            ///< where the world rotates [m]
    Vec3 slip_velocity;    ///< of B against A at the contact, middle of the step, normal part taken out [m/s]
    const double* before;  ///< its history
    double* now;
    double radius;     ///< R* [m]
    double stiffness;  ///< k_n [N/m]
    double grip;       ///< N + adhesion [N]: limit of friction and rolling over their coefficients
  };

  SmoothSums run(const Call& call);
  SmoothSums evaluate_block(const Call& call, std::size_t begin, std::size_t end);
  void evaluate(const Call& call, std::size_t i, SmoothSums& sums);
  void evaluate_uncounted(const Call& call, std::size_t i);
  void leave(const Call& call, std::size_t i);
  ContactKinematics move(const Call& call, Touch& t) const;
  Vec3 change_at(const Call& call, const Touch& t) const;
  Vec3 slide(const Call& call, const Touch& t, SmoothSums& sums) const;
  Vec3 slide_by_pointer(const Call& call, const Touch& t, SmoothSums& sums) const;
  SlipStep slip_step(const Call& call, const Touch& t) const;
  Vec3 damp(const Call& call, const Touch& t, const CoulombSpring::Parameters& p, const Vec3& elastic,
            SmoothSums& sums) const;
  Vec3 roll(const Call& call, const Touch& t, SmoothSums& sums) const;
  void drive(const Call& call, const Touch& t, SmoothSums& sums) const;
  void record(const SmoothSums& now, const ContactSet& contacts, double dt, StepReport& report);

  SmoothLaw law_;
  NormalEvaluation normal_;
  std::size_t rolling_at_ = 0;  ///< number of a record with which the rolling spring begins
  VelocityChange change_;
  RecordMemory memory_;
  Incidence incidence_;
  TouchedBodies touched_;  ///< where they are few
  std::vector<SmoothSums> blocks_;
  SmoothSums before_;  ///< of the last call
  StepRatio ratio_;
};

}  // namespace epafi
