#include "viz_export/measure_recorder.h"

#include <algorithm>
#include <cmath>

namespace epafi {

void MeasureRecorder::observe(const StepView& view) {
  measure_->sample(view, values_);
  for (std::size_t k = 0; k < values_.size(); ++k) {
    Statistics& s = statistics_[k];
    s.last = values_[k];
    if (std::isnan(values_[k])) continue;
    s.min = std::min(s.min, values_[k]), s.max = std::max(s.max, values_[k]);
  }
  sink_(view.world.time, name_, components_, values_);
}

void MeasureRecorder::visit(StateVisitor& visitor) {
  const std::string prefix = "measure/" + name_;
  visitor.column(prefix + "/statistics", statistics_);
  measure_->visit(visitor, prefix);
}

}  // namespace epafi
