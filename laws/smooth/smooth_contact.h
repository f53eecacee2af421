/// @file smooth_contact.h  The loop of smooth contact: forces of all contacts, in tiles, by the parts of one law, then
/// sums by body. Dampers use velocities at the time of the detection (StepClock::velocity_lag), predicted with the
/// stored acceleration; springs use the displacement over the step, the velocity in its middle times dt. Both are
/// second order with velocity Verlet.
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
  double elastic = 0.0;               ///< of the normal parts [J]
  double spring_energy = 0.0;         ///< of the friction and rolling springs [J]
  double spring_energy_before = 0.0;  ///< of the same contacts at the last step [J]
  double slipped = 0.0;               ///< work done on the springs during the step, less growth of their energy [J]
  double viscous_power = 0.0;         ///< lost in dampers now [W]
  double late = 0.0;                  ///< as DashpotLoss::late [J]
  double driven_power = 0.0;          ///< of driven bodies on the others now [W]
  double lost = 0.0;                  ///< to plastic deformation and adhesion during the step [J]

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

/// Contacts `begin` to `end`.
struct SmoothCall {
  const World& world;
  ContactSet& contacts;
  const SmoothLaw& law;
  const Passes& passes;
  const VelocityChange& change;
  RecordMemory& memory;
  double dt, lag;
  double ratio;  ///< as DamperStep::before
  std::size_t begin, end;
  SmoothSums& sums;
};
/// The loop over them for the widest lanes of now (laws/smooth/contact_tiles.cpp).
void (*contact_tiles())(const SmoothCall&);

class SmoothContact final : public ContactModel {
 public:
  explicit SmoothContact(SmoothLaw law);

  const char* name() const override { return "smooth"; }
  void act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) override;
  void reorder(const Reordering& change) override;
  void visit(StateVisitor& visitor) override;

 private:
  SmoothSums run(const World& world, ContactSet& contacts, double dt, double lag);
  void record(const SmoothSums& now, const ContactSet& contacts, double dt, StepReport& report);

  SmoothLaw law_;
  VelocityChange change_;
  RecordMemory memory_;
  Incidence incidence_;
  TouchedBodies touched_;  ///< where they are few
  std::vector<SmoothSums> blocks_;
  SmoothSums before_;  ///< of the last call
  StepRatio ratio_;
};

}  // namespace epafi
