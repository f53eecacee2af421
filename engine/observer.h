/// @file observer.h  Whoever looks at finished steps: measures, files, ledgers of overlap. Const access only, so output cannot
/// change a trajectory.
#pragma once
#include "engine/energy.h"
#include "engine/pipeline.h"

namespace epafi {

/// A finished step. Contacts are those of the last detection.
struct StepView {
  const World& world;
  const ContactSet& contacts;
  const PairList& pairs;
  const StepReport& report;
  const EnergyLedger& ledger;
  std::uint64_t step = 0;  ///< steps done so far
  double dt = 0.0;         ///< [s]
  bool last = false;       ///< the run ends with this step
};

/// Called when `is_due`; the simulation measures the energies before if `wants_energy`.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual bool is_due(std::uint64_t step) const = 0;
  virtual bool wants_energy(std::uint64_t /*step*/) const { return false; }
  virtual void observe(const StepView& view) = 0;
  virtual void visit(StateVisitor&) {}
};

/// Due every `every` steps and at step 0.
class EverySteps {
 public:
  explicit EverySteps(std::uint64_t every = 1) : every_(every < 1 ? 1 : every) {}
  bool is_due(std::uint64_t step) const { return step % every_ == 0; }

 private:
  std::uint64_t every_;
};

}  // namespace epafi
