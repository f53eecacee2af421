/// @file energy.h  The energy ledger: stored, dissipated and supplied energy. Its error is checked in every run.
/// relative_error = (E(t) - E(0) + dissipated - work) / E_ref, E_ref = max over time of kinetic + |elastic|, plus the
/// spread of the potential energy, min(|work|, dissipated) and a step of free fall (energy.cpp); elastic is negative
/// where adhesion holds bodies. Potential energy: of constant gravity and external forces. Energy from position
/// correction is part of the error and is also reported separately. `gained` is the energy that contacts created: the
/// largest drop of `taken` below its earlier maximum. No term balances it, so it stays in the error. Work of dashpots
/// is booked by the velocity in the middle of the step and corrected in the next steps; such a correction is no gain.
/// Sums over bodies do not depend on the order.
#pragma once
#include "engine/state/state_visitor.h"
#include "engine/state/world.h"
#include "engine/step/report.h"
#include "engine/step/totals.h"

namespace epafi {

/// Kinetic energy of one body, translation and rotation [J]; 0 for a fixed or driven one.
double kinetic_energy(const World& world, Slot body);
/// Of all free bodies [J].
double kinetic_energy(const World& world);
/// -(m g + F).x of one body along its path [J]; 0 for a fixed or driven one.
double potential_energy(const World& world, Slot body);
/// Of all free bodies [J].
double potential_energy(const World& world);
/// sum m v of the free bodies [N s].
Vec3 linear_momentum(const World& world);

struct Energy {
  double kinetic = 0, potential = 0, elastic = 0;  ///< stored now [J]
  double dissipated = 0, work = 0;                 ///< since the start [J]
  double correction = 0;                           ///< created by position correction, since the start [J]
  double gained = 0;                               ///< created by contacts [J], >= 0
  double taken = 0;                                ///< net energy that contacts took from the bodies [J]
  Losses losses;                                   ///< parts of `dissipated`, of smooth contact
  double stored() const { return kinetic + potential + elastic; }
};

class EnergyLedger {
 public:
  /// Starts from the state of time 0. met: energy lost as bodies of that state come into contact; E(0) includes it.
  void start(const World& world, const StepReport& report, const Losses& met = {});
  /// Adds losses and work of a step. fall: |g| dt [m/s], the accuracy of velocities in non-smooth contact.
  void add(const StepReport& report, double fall = 0.0);
  /// Adds the work of time-dependent loads [J].
  void add_work(double work) { now_.work += work; }
  /// Bodies were added or removed: the jump of stored energy counts as work.
  void accept_jump(const World& world, double stored_before);
  /// Bodies with these energies [J] were added.
  void accept_bodies(double kinetic, double potential);
  /// Sets the elastic energy after such a change; call it before accept_jump.
  void take_elastic(const StepReport& report) { now_.elastic = report.elastic; }
  /// Measures the stored energies and extends E_ref, in one pass over the bodies.
  Energy measure(const World& world) { return measure(body_totals(world)); }
  Energy measure(const BodyTotals& bodies);

  const Energy& last() const { return now_; }
  double relative_error() const { return relative(error()); }
  /// The same without the energy of position correction.
  double unexplained_error() const { return relative(error() - now_.correction); }
  /// What E_ref holds beside stored energies: min(|work|, dissipated) and a step of free fall [J].
  double beside_stored() const;
  double stored(const World& world) const { return kinetic_energy(world) + potential_energy(world) + now_.elastic; }
  void visit(StateVisitor& visitor);

 private:
  double error() const;  ///< [J]
  double relative(double error) const;
  Energy now_;
  double start_ = 0;          ///< E(0) [J]
  double settled_ = 0;        ///< maximum of `taken` minus early_ [J]
  double early_ = 0;          ///< loss of dashpots that the next steps may correct: twice a step's, halved by each [J]
  double largest_inner_ = 0;  ///< max of kinetic + |elastic| [J]
  double lowest_potential_ = 0, highest_potential_ = 0;
  double mass_ = 0;  ///< of the free bodies when the energies were last measured [kg]; with impulses only
  double fall_ = 0;  ///< speed that the last step of impulses gave a free body [m/s]
};

}  // namespace epafi
