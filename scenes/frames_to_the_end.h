/// @file frames_to_the_end.h  Frames of a run whose end is one of them.
#pragma once
#include <cmath>
#include <memory>

#include "viz_export/output/output_observers.h"

namespace epafi {

/// Frames of a run whose end is one of them. The last step may be beyond the duration, so that the step nearest to the
/// last multiple of the interval is the one before; the final frame then replaces it.
class FramesToTheEnd final : public Observer {
 public:
  FramesToTheEnd(std::unique_ptr<StateRecorder> frames, std::uint64_t last) : frames_(std::move(frames)), last_(last) {}
  bool is_due(std::uint64_t step) const override { return step + 1 != last_ && frames_->is_due(step); }
  ContactView wants_contacts(std::uint64_t step, bool last) const override {
    return last || is_due(step) ? frames_->wants_contacts(step, last) : ContactView::none;
  }
  void observe(const StepView& view) override { frames_->observe(view); }

 private:
  std::unique_ptr<StateRecorder> frames_;
  std::uint64_t last_;
};

/// True if the duration is a multiple of the interval that no step meets.
inline bool ends_between_steps(double duration, double interval, double dt) {
  const double intervals = duration / interval, steps = duration / dt;
  return std::abs(intervals - std::round(intervals)) < 1e-9 * intervals && std::abs(steps - std::round(steps)) > 1e-6;
}

}  // namespace epafi
