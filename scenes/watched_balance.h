/// @file watched_balance.h  Monitors the energy error of a run. Gains and losses are summed separately, so that they
/// cannot cancel.
///   unexplained   stored + taken by contacts - work: changed only by errors of the scheme and position correction
///   put in        minus the energy taken by contacts: should never rise
/// Both signals are split into monotonic swings between turning points. Swings below 1e-3 of the reference energy (as
/// in the ledger: largest kinetic + elastic energy, plus the spread of the potential energy) are oscillations of
/// contacts, and swings of up to 0.0075 those of the scheme on springs; both are ignored. Larger rises and falls are
/// summed. A steady change is one swing, however slow. The sums are compared with the energy exchanged since the start:
/// the reference plus all dissipation.
///
/// Noise. Non-smooth solvers leave velocity errors of about the residual times g dt. Energies M (g dt)^2 / 2 of all
/// bodies, and that of one step of unopposed servo walls, times 1000 times the residual, are added to the exchanged
/// energy in every step. With smooth contact the only noise is rounding of positions: the kinetic energy of a rounding
/// error per step.
#pragma once
#include "engine/step/observer.h"

namespace epafi {

class WatchedBalance {
 public:
  /// share: relative oscillation of the energy of springs that the scheme causes.
  void allow_swing(double share);
  /// Call after every step.
  void note(const StepReport& report);
  /// Call after the energies were measured.
  void look(const StepView& view);
  /// Call after a legitimate jump of the stored energy (a new stage): sums are kept, signals restart at the next look.
  void begin_stage();

  /// The present result.
  struct Finding {
    double share = 0.0;  ///< largest error: net, gained or lost, over the energy exchanged
    double net = 0.0;    ///< error of the ledger now, over the energy exchanged; > 0: gained
    /// Error that can end a run, the larger of two: the ledger's without position correction, over the reference if it
    /// exceeds 0.05 of the energy exchanged, else over the latter; and `put_in` over the energy exchanged.
    double wide = 0.0;
    double gained = 0.0;  ///< energy created [J]
    double lost = 0.0;    ///< energy lost without a booked cause [J]
    double put_in = 0.0;  ///< part of `gained`, by contacts [J]
    bool warns = false;   ///< above the warning threshold for 40 steps
    bool ends = false;    ///< above the threshold that ends a run, for 40 steps
  };
  const Finding& finding() const { return finding_; }
  void visit(StateVisitor& visitor);

 private:
  /// Sums of rises and falls of a value, without swings below a band.
  struct Swings {
    double rises = 0, falls = 0;  ///< booked, both >= 0 [J]
    double turn = 0;              ///< value at the last turning point
    double far = 0;               ///< most distant value since then
    double direction = 0;         ///< 1, -1, or 0 at the start
    void follow(double value, double band);
    void settle() { *this = {risen(), fallen(), 0, 0, 0}; }
    double risen() const { return rises + (direction > 0 ? far - turn : 0.0); }
    double fallen() const { return falls + (direction < 0 ? turn - far : 0.0); }
  };
  struct State {  // plain: one value of the checkpoint
    Swings unexplained, put_in;
    double started = 0, since_warns = 0, since_wide = 0;  ///< step at which a threshold was exceeded; 0: it is not
    double noisy_steps = 0;  ///< steps since the last look, weighted by residual: 1 from a residual of 1e-3 on
    double noise = 0;        ///< expected energy errors of servos and residuals [J]
    double inner = 0;        ///< largest kinetic and elastic energy together [J]
    double lowest = 0, highest = 0, potential = 0;  ///< potential energy, and that of the last look [J]
    double bodies = 0;                              ///< at the last look
  };
  double rounding_energy(const StepView& view) const;
  double reference(const StepView& view);
  void judge(const StepView& view, double reference);

  State state_;
  Finding finding_;
  double band_ = 1e-3;  ///< ignored swings of contacts over the reference energy; automatic time steps cause less
};

}  // namespace epafi
