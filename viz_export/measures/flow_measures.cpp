#include "viz_export/measures/flow_measures.h"

#include <utility>

#include "engine/parallel.h"

namespace epafi {

MassFlow::MassFlow(MeasureSetup setup)
    : setup_(std::move(setup)), point_(setup_.parameters.vec3("plane.point")),
      normal_(setup_.parameters.vec3("plane.normal").normalized()), window_(setup_.parameters.number("window")) {}

/// How many of the planes a body has before it: one, or in a cell that repeats across it one per cell of its path.
int MassFlow::level(const World& w, Slot s) const {
  int axis = -1;
  for (int k = 0; w.cell && k < 3; ++k)
    if (w.cell->repeats[static_cast<std::size_t>(k)] && std::abs(normal_[k]) > 1 - 1e-12) axis = k;
  if (axis < 0) return (w.position[s] - point_).dot(normal_) > 0 ? 1 : 0;
  return static_cast<int>(std::floor((w.unwrapped(s) - point_).dot(normal_) / w.cell->size[axis]));
}

void MassFlow::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  level_.resize(w.ids_given(), unseen);
  mass_ += block_sum<double>(level_.size(), [&](std::size_t id) {
    const Slot s = w.slot_of(static_cast<BodyId>(id));
    if (s == no_slot || !w.is_movable(s)) return 0.0;
    const int now = level(w, s), before = std::exchange(level_[id], now);
    return before == unseen ? 0.0 : (now - before) / w.inverse_mass[s];
  });
  times_.push_back(w.time), masses_.push_back(mass_);
  std::size_t first = 0;  // the youngest sample at least a window old, or the oldest there is
  while (first + 1 < times_.size() && times_[first + 1] <= w.time - window_ * (1 - 1e-9)) ++first;
  times_.erase(times_.begin(), times_.begin() + static_cast<std::ptrdiff_t>(first));
  masses_.erase(masses_.begin(), masses_.begin() + static_cast<std::ptrdiff_t>(first));
  const double span = w.time - times_.front();
  values = {span > 0 ? (mass_ - masses_.front()) / span : 0.0, mass_};
}

void MassFlow::visit(StateVisitor& visitor, const std::string& prefix) {
  visitor.value(prefix + "/mass", mass_), visitor.column(prefix + "/level", level_);
  visitor.column(prefix + "/times", times_), visitor.column(prefix + "/masses", masses_);
}

}  // namespace epafi
