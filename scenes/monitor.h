/// @file monitor.h  Watches a run: what summary.json reports and what [bounds] forbids. An observer like any other.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "detection/shape_store.h"
#include "engine/body_ids.h"
#include "engine/observer.h"
#include "scenes/scene.h"

namespace epafi {

/// Worst and mean overlap over the pairs that overlap (interface.md); a pair's overlap is that of its deepest point.
struct Overlap {
  double max = 0.0, mean = 0.0;  ///< [m]
  double max_relative = 0.0;     ///< to the smaller body's bounding radius
  std::size_t pairs = 0;
};
Overlap measure_overlap(const World& world, const ContactPieces& contacts, const ShapeStore& shapes);

/// A bound of the scene with what was seen.
struct BoundCheck {
  std::string name;
  double value = 0.0, bound = 0.0;
  bool ok = true;
};

class RunMonitor final : public Observer {
 public:
  /// steps: of the whole run; overlap counts over its last tenth. interval: steps between looks at overlap and bounds.
  /// bound_bodies: of [bounds], then of [accuracy].
  RunMonitor(const Scene& scene, const std::vector<BodyIds>& bound_bodies, const ShapeStore& shapes,
             std::uint64_t steps, std::uint64_t interval);
  bool is_due(std::uint64_t) const override { return true; }
  bool wants_energy(std::uint64_t step) const override { return step % interval_ == 0; }
  bool wants_bodies(std::uint64_t step) const override { return step % interval_ == 0; }
  ContactView wants_contacts(std::uint64_t step, bool last) const override {
    return last || step % interval_ == 0 ? ContactView::pieces : ContactView::none;
  }
  void observe(const StepView& view) override;
  void visit(StateVisitor& visitor) override;

  std::optional<BoundCheck> violated() const;
  /// Of [bounds]: worst value of the whole run.
  std::vector<BoundCheck> checks() const {
    return {checks_.begin(), checks_.begin() + static_cast<std::ptrdiff_t>(stopping_)};
  }
  /// Of [accuracy]: what came out beside what the scene needs. The overlap is that of overlap().
  std::vector<BoundCheck> accuracy() const;
  double contacts_mean() const { return totals_.steps > 0 ? totals_.contacts / totals_.steps : 0.0; }
  double residual_max() const { return totals_.residual_max; }
  double residual_mean() const { return totals_.steps > 0 ? totals_.residual / totals_.steps : 0.0; }
  double iterations_max() const { return totals_.iterations_max; }
  double iterations_mean() const { return totals_.steps > 0 ? totals_.iterations / totals_.steps : 0.0; }
  std::uint64_t not_converged() const { return static_cast<std::uint64_t>(totals_.not_converged); }
  double body_steps() const { return totals_.body_steps; }
  std::optional<double> momentum_error() const { return momentum_error_; }
  /// Of the last tenth; of the last look where the run ended before.
  Overlap overlap() const;
  Overlap last_overlap() const { return last_overlap_; }

 private:
  void look(const StepView& view);
  void look_at_momentum(const StepView& view);
  void check(const StepView& view);
  double value_of(std::size_t bound, const StepView& view);

  struct Totals {  // plain, so that it is checkpointed as one value
    double steps = 0, contacts = 0, residual = 0, residual_max = 0, iterations = 0, iterations_max = 0,
           not_converged = 0;
    double body_steps = 0, overlap_max = 0, overlap_mean = 0, overlap_relative = 0, overlap_looks = 0;
  };
  struct Momentum {
    double start[3] = {0, 0, 0}, largest = 0, error = 0, started = 0;
  };
  std::vector<BoundSpec> bounds_;  ///< of [bounds], then of [accuracy]
  std::size_t stopping_;           ///< the first so many end the run
  std::vector<BodyIds> bound_bodies_;
  std::vector<std::vector<Vec3>> bound_start_;
  std::vector<BoundCheck> checks_;
  const ShapeStore& shapes_;
  std::uint64_t steps_, interval_;
  Totals totals_;
  Momentum momentum_;
  Overlap last_overlap_;
  std::optional<double> momentum_error_;
};

}  // namespace epafi
