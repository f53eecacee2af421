/// @file monitor.h  Observer for the results in summary.json and for [bounds].
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "detection/shape_store.h"
#include "engine/state/body_ids.h"
#include "engine/step/observer.h"
#include "engine/step/warnings.h"
#include "scenes/scene.h"
#include "scenes/watched_balance.h"

namespace epafi {

/// Worst and mean overlap over the pairs that overlap (engine/step/totals.h).
struct Overlap {
  double max = 0.0, mean = 0.0;  ///< [m]
  double max_relative = 0.0;     ///< to the smaller body's bounding radius
  std::size_t pairs = 0;
};
Overlap measure_overlap(const World& world, const ContactPieces& contacts, const ShapeStore& shapes);
/// A warning if the deepest overlap, over the smaller body's bounding radius, is beyond the range of every contact law;
/// else empty.
std::string deep_overlap_text(double relative);

/// A bound of the scene with its worst value.
struct BoundCheck {
  std::string name;
  double value = 0.0, bound = 0.0;
  bool ok = true;
};

class RunMonitor final : public Observer {
 public:
  /// steps: of the whole run; the mean overlap is that of its last tenth. interval: steps between samples of energy and
  /// mean overlap; the largest overlap, the residual and displacements of bodies are sampled in every step.
  /// bound_bodies: of [bounds], then of [accuracy].
  struct Setup {
    std::uint64_t steps = 0, interval = 1;
    double least_radius = 0.0;     ///< of all present and later bodies [m]: avoids most radii
    double swing = 0.0;            ///< WatchedBalance::allow_swing
    std::string way_to_balance{};  ///< advice if the law itself may cause energy errors; "": it does not
  };
  RunMonitor(const Scene& scene, const std::vector<BodyIds>& bound_bodies, const ShapeStore& shapes, const Setup& setup,
             Warnings& warnings);
  bool is_due(std::uint64_t) const override { return true; }
  bool wants_energy(std::uint64_t step) const override { return step % interval_ == 0; }
  bool wants_bodies(std::uint64_t) const override { return follows_bodies_; }
  ContactView wants_contacts(std::uint64_t step, bool last) const override {
    return last || step % interval_ == 0 ? ContactView::overlaps : ContactView::none;
  }
  void observe(const StepView& view) override;
  void bodies_come(const World& world, std::size_t first) override;
  void bodies_leave(const World& world, std::span<const BodyId> bodies) override;
  /// After the last step of a run that is cut off: warns of a balance that has opened since the last look.
  void report_balance(const StepView& view) { watch_energy(view); }
  void visit(StateVisitor& visitor) override;

  std::optional<BoundCheck> violated() const;
  /// A reached bound with then = "stop", which ends the run without failure.
  std::optional<BoundCheck> reached() const;
  /// Last value of a bound on a measure; NaN if there is none.
  void read_measures(std::function<double(const Condition&)> value) { measured_ = std::move(value); }
  /// Where gravity or stiffness change the stored energy jumps, and the ledger accepts it; the watch counts from there.
  /// So does that of momentum: bodies come and go, and what drives them changes.
  void begin_stage() {
    energy_.begin_stage();
    momentum_.started = 0;
  }
  /// Of [bounds]: worst value of the whole run.
  std::vector<BoundCheck> checks() const {
    std::vector<BoundCheck> out(checks_.begin(), checks_.begin() + static_cast<std::ptrdiff_t>(stopping_));
    if (balance_) out.push_back(*balance_);
    return out;
  }
  /// Results of [accuracy] beside the required values.
  std::vector<BoundCheck> accuracy() const;
  double contacts_mean() const { return totals_.steps > 0 ? totals_.contacts / totals_.steps : 0.0; }
  double residual_max() const { return totals_.residual_max; }
  double residual_mean() const { return totals_.steps > 0 ? totals_.residual / totals_.steps : 0.0; }
  double iterations_max() const { return totals_.iterations_max; }
  double iterations_mean() const { return totals_.steps > 0 ? totals_.iterations / totals_.steps : 0.0; }
  std::uint64_t not_converged() const { return static_cast<std::uint64_t>(totals_.not_converged); }
  double body_steps() const { return totals_.body_steps; }
  std::optional<double> momentum_error() const { return momentum_error_; }
  /// Largest of all steps; the mean is that of the last tenth, of the last look where the run ended before.
  Overlap overlap() const;
  Overlap last_overlap() const { return last_overlap_; }

 private:
  void look(const StepView& view);
  void note_overlap(const StepView& view);
  void watch_energy(const StepView& view);
  void watch_solver(const StepView& view);
  void watch_models(const StepView& view);
  template <class Relative>
  void warn_of_overlap(const StepView& view, const Relative& relative);
  void look_at_momentum(const StepView& view);
  void shift_momentum(const World& world, Slot body, double sign);
  void check(const StepView& view, bool all);
  void check_measure(std::size_t bound, const StepView& view);
  double value_of(std::size_t bound, const StepView& view);

  struct Totals {  // plain, so that it is checkpointed as one value
    double steps = 0, contacts = 0, residual = 0, residual_max = 0, iterations = 0, iterations_max = 0,
           not_converged = 0;
    double body_steps = 0, overlap_max = 0, overlap_mean = 0, overlap_relative = 0, overlap_looks = 0;
  };
  struct Momentum {
    double start[3] = {0, 0, 0}, largest = 0, error = 0, started = 0;
  };
  WatchedBalance energy_;
  std::vector<BoundSpec> bounds_;  ///< of [bounds], then of [accuracy]
  std::size_t stopping_;           ///< the first so many end the run
  std::vector<BodyIds> bound_bodies_;
  std::vector<std::vector<Vec3>> bound_start_;
  std::vector<BoundCheck> checks_;
  std::optional<BoundCheck> balance_;  ///< the energy error, if it is beyond the limit of all runs
  const ShapeStore& shapes_;
  std::uint64_t steps_, interval_;
  std::string way_to_balance_;
  double least_radius_;
  Warnings& warnings_;
  bool watches_balance_;  ///< the scene sets no bound of its own on the energy error
  Totals totals_;
  Momentum momentum_;
  Overlap last_overlap_;
  bool follows_bodies_ = false;  ///< a bound on the motion of bodies: sampled in every step
  std::optional<double> momentum_error_;
  std::function<double(const Condition&)> measured_{};
  std::vector<double> left_since_;  ///< by bound: when a measure began to be out of it [s]; < 0: it is not
};

}  // namespace epafi
