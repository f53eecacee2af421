/// @file watched_balance.h  The energy balance of a run as its watch books it: what bodies gained and what was lost
/// track of, each by itself, so that losses never pay for gains.
///   unexplained   stored + taken by contacts - work: only the scheme and the position correction move it
///   put in        minus what contacts took: it should only fall
/// Both are followed from turning point to turning point. A swing smaller than a thousandth of the reference energy (as
/// the ledger's: largest kinetic and elastic energy, and the spread of the potential one) is that of a contact in
/// motion and comes back, as is one by which the scheme's energy swings on springs (at most 0.0075 of it); all others
/// are added up, rises and falls apart. A steady change is one swing, however slow. The sums are held against the
/// energy exchanged since the start: the reference and all that was dissipated.
///
/// Noise. Solvers of impulses leave velocities of their residual times one step of free fall, M (g dt)^2 / 2 in all
/// bodies, and of one step of servo walls that nothing holds; a thousand times its part by the residual is added to
/// what was exchanged in every step. Under smooth contact only rounding of the positions is noise: what bodies a
/// rounding apart have moved with, once a step.
#pragma once
#include "engine/step/observer.h"

namespace epafi {

class WatchedBalance {
 public:
  /// By which share the scheme lets the energy of springs swing.
  void allow_swing(double share);
  /// After every step.
  void note(const StepReport& report);
  /// After the energies were measured.
  void look(const StepView& view);
  /// Stored energy jumps here, rightly: what was booked and exchanged before stays, the next look is where it goes on.
  void begin_stage();

  /// What stands open, and since when.
  struct Finding {
    double share = 0.0;   ///< the largest of all below, of the energy exchanged
    double net = 0.0;     ///< of the ledger's balance now, > 0: gained
    double wide = 0.0;    ///< what ends a run where it is too large: the same without position correction, of the
                          ///< reference (as the summary's error) where it is more than 0.05 of the energy exchanged; or
                          ///< what contacts put in, of the energy exchanged
    double gained = 0.0;  ///< all that bodies gained [J]
    double lost = 0.0;    ///< all that was lost track of [J]
    double put_in = 0.0;  ///< by contacts, part of `gained` [J]
    bool warns = false;   ///< open for long enough to be reported
    bool ends = false;    ///< so far, for so long, that the run ends
  };
  const Finding& finding() const { return finding_; }
  void visit(StateVisitor& visitor);

 private:
  /// Rises and falls of a value, swings below a band left out.
  struct Swings {
    double rises = 0, falls = 0;  ///< booked, both >= 0 [J]
    double turn = 0;              ///< the last turning point
    double far = 0;               ///< the farthest since
    double direction = 0;         ///< 1, -1, or 0 at the start
    void follow(double value, double band);
    void settle() { *this = {risen(), fallen(), 0, 0, 0}; }
    double risen() const { return rises + (direction > 0 ? far - turn : 0.0); }
    double fallen() const { return falls + (direction < 0 ? turn - far : 0.0); }
  };
  struct State {  // plain: one value of the checkpoint
    Swings unexplained, put_in;
    double started = 0, since_warns = 0, since_wide = 0;  ///< steps since which it is open; 0: it is not
    double noisy_steps = 0;  ///< since the last look: by residual, 1 where it is a thousandth or more
    double noise = 0;        ///< so far [J]
    double inner = 0;        ///< largest kinetic and elastic energy together [J]
    double lowest = 0, highest = 0, potential = 0;  ///< potential energy, and that of the last look [J]
    double bodies = 0;                              ///< at the last look
  };
  double rounding_energy(const StepView& view) const;
  double reference(const StepView& view);
  void judge(const StepView& view, double reference);

  State state_;
  Finding finding_;
  double band_ = 1e-3;  ///< of the reference: swings of contacts; automatic steps err by less of all energy
};

}  // namespace epafi
