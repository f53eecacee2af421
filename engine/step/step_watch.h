/// @file step_watch.h  Measures the stiffness of the contacts at intervals, and divides the time step or stops the run
/// where the present state makes the step unstable. Its decision depends on the state alone: it is the same for every
/// number of threads and after a restart (`visit`).
#pragma once
#include <optional>

#include "engine/step/domain.h"
#include "engine/step/observer.h"

namespace epafi {

class StepWatch {
 public:
  virtual ~StepWatch() = default;
  /// After this step it reads the contacts, piece by piece.
  virtual bool is_due(std::uint64_t step) const = 0;
  /// After every step, cheap: `deepest` is its largest overlap [m].
  virtual void note(std::uint64_t step, double deepest) = 0;
  /// After a step in which it is due. True: by this bound on what it looks for (stiffness_bound) the look is done.
  virtual bool passes(std::uint64_t /*step*/, double /*bound*/) { return false; }
  /// After a step in which it is due and has not passed: into how many equal parts the next ones are divided, or why
  /// the run stops.
  virtual std::optional<Failure> look(const StepView& view) = 0;
  virtual int parts() const = 0;
  virtual void visit(StateVisitor& visitor) = 0;
};

}  // namespace epafi
