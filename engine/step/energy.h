/// @file energy.h  The energy ledger: what is stored, what was lost, what came in. It must close in every run.
/// relative_error = (E(t) - E(0) + dissipated - work) / E_ref, E_ref = max over time of kinetic + |elastic|, plus the
/// spread of the potential energy; elastic is negative where adhesion holds bodies. Potential: gravity and external
/// forces, not their parts that follow time. What position correction puts in is part of the error and shown by itself.
/// Where contacts put in more than they took since they had taken most, the difference is `gained`, which no term
/// balances, so that it stays in the error. Of dashpots a step books what their forces do by the velocity of its
/// middle, and the rest when the next steps know it: what they take back of the last steps' dashpots is no gain. Sums
/// over bodies depend on no order.
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
  double correction = 0;                           ///< put in by moving overlapping bodies apart, since the start [J]
  double gained = 0;                               ///< most that contacts had put in beyond what they took [J], >= 0
  double taken = 0;                                ///< by contacts, less what they put in [J]
  Losses losses;                                   ///< parts of `dissipated`, of smooth contact
  double stored() const { return kinetic + potential + elastic; }
};

class EnergyLedger {
 public:
  /// The state of time 0. met: lost where bodies meet in it; E(0) is that before they do.
  void start(const World& world, const StepReport& report, const Losses& met = {});
  /// After every step: adds its losses and work.
  /// fall: |g| dt [m/s], the speed that a step of impulses knows velocities to.
  void add(const StepReport& report, double fall = 0.0);
  /// Of loads that follow time [J].
  void add_work(double work) { now_.work += work; }
  /// Bodies were added or removed: the jump of stored energy counts as work.
  void accept_jump(const World& world, double stored_before);
  /// Bodies with these energies [J] came in.
  void accept_bodies(double kinetic, double potential);
  /// The elastic energy after such a change, before the jump is accepted.
  void take_elastic(const StepReport& report) { now_.elastic = report.elastic; }
  /// Stored energies now; extends E_ref. Costs one pass over the bodies, so call it as often as the error is wanted.
  Energy measure(const World& world) { return measure(body_totals(world)); }
  Energy measure(const BodyTotals& bodies);

  const Energy& last() const { return now_; }
  double relative_error() const { return relative(error()); }
  /// The same without what position correction put in, whose cause is known.
  double unexplained_error() const { return relative(error() - now_.correction); }
  double stored(const World& world) const { return kinetic_energy(world) + potential_energy(world) + now_.elastic; }
  void visit(StateVisitor& visitor);

 private:
  double error() const;  ///< [J]
  double relative(double error) const;
  Energy now_;
  double start_ = 0;          ///< E(0) [J]
  double settled_ = 0;        ///< most that contacts had taken but for what is early [J]
  double early_ = 0;          ///< of dashpots, that the next steps may take back: twice a step's, halved by each [J]
  double largest_inner_ = 0;  ///< max of kinetic + |elastic| [J]
  double lowest_potential_ = 0, highest_potential_ = 0;
  double mass_ = 0;  ///< of the free bodies when the energies were last measured [kg]; with impulses only
  double fall_ = 0;  ///< speed that the last step of impulses gave a free body [m/s]
};

}  // namespace epafi
