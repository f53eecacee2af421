/// @file step_watch.h  Measures the stiffness of the contacts at intervals, and divides the time step or stops the run
/// if the step is unstable in the present state. Its decision depends on the state alone: it is the same for every
/// number of threads and after a restart (`visit`).
#pragma once
#include <optional>

#include "engine/step/domain.h"
#include "engine/step/observer.h"

namespace epafi {

class StepWatch {
 public:
  virtual ~StepWatch() = default;
  /// True if it reads the contacts after this step, piece by piece.
  virtual bool is_due(std::uint64_t step) const = 0;
  /// Call after every step (cheap); deepest: its largest overlap [m].
  virtual void note(std::uint64_t step, double deepest) = 0;
  /// Call after a step in which it is due, with the bound of stiffness_bound. True: the bound shows stability.
  virtual bool passes(std::uint64_t /*step*/, double /*bound*/) { return false; }
  /// Call if the bound does not. Returns the number of equal parts of the next steps, or the reason to stop the run.
  virtual std::optional<Failure> look(const StepView& view) = 0;
  virtual int parts() const = 0;
  virtual void visit(StateVisitor& visitor) = 0;
};

}  // namespace epafi
