#include "viz_export/measures/flow_measures.h"

namespace epafi {

MassFlow::MassFlow(MeasureSetup setup)
    : setup_(std::move(setup)), point_(setup_.parameters.vec3("plane.point")),
      normal_(setup_.parameters.vec3("plane.normal").normalized()), window_(setup_.parameters.number("window")) {}

void MassFlow::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  behind_.resize(w.ids_given(), 2);
  for (std::size_t id = 0; id < behind_.size(); ++id) {
    const Slot s = w.slot_of(static_cast<BodyId>(id));
    if (s == no_slot || !w.is_movable(s)) continue;
    const char now = (w.position[s] - point_).dot(normal_) > 0 ? 1 : 0;
    if (behind_[id] != 2 && now != behind_[id]) mass_ += (now ? 1.0 : -1.0) / w.inverse_mass[s];
    behind_[id] = now;
  }
  times_.push_back(w.time), masses_.push_back(mass_);
  std::size_t first = 0;  // the youngest sample at least a window old, or the oldest there is
  while (first + 1 < times_.size() && times_[first + 1] <= w.time - window_ * (1 - 1e-9)) ++first;
  times_.erase(times_.begin(), times_.begin() + static_cast<std::ptrdiff_t>(first));
  masses_.erase(masses_.begin(), masses_.begin() + static_cast<std::ptrdiff_t>(first));
  const double span = w.time - times_.front();
  values = {span > 0 ? (mass_ - masses_.front()) / span : 0.0, mass_};
}

void MassFlow::visit(StateVisitor& visitor, const std::string& prefix) {
  visitor.value(prefix + "/mass", mass_), visitor.column(prefix + "/behind", behind_);
  visitor.column(prefix + "/times", times_), visitor.column(prefix + "/masses", masses_);
}

}  // namespace epafi
