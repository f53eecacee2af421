#include "viz_export/measures/flow_measures.h"

#include <cmath>
#include <utility>

#include "engine/threads/parallel.h"

namespace epafi {

MassFlow::MassFlow(MeasureSetup setup)
    : setup_(std::move(setup)),
      point_(setup_.parameters.vec3("plane.point")),
      normal_(setup_.parameters.vec3("plane.normal").normalized()),
      window_(setup_.parameters.number("window")) {}

/// Number of planes that a body has passed: that of the scene and its images along periodic axes. A wrap along an axis
/// in the direction of the normal passes one more, at any position across it.
int MassFlow::level(const World& w, Slot s) const {
  if (!w.cell) return (w.position[s] - point_).dot(normal_) > 0 ? 1 : 0;
  constexpr double along_plane = 1e-12;  // component of the normal: an axis within the plane has no images of it
  int laps = 0;
  for (int k = 0; k < 3; ++k) {
    if (!w.cell->repeats[static_cast<std::size_t>(k)] || std::abs(normal_[k]) <= along_plane) continue;
    const int lap = w.wraps[s][k] + static_cast<int>(w.cell->cells_to(w.position[s], k));
    laps += normal_[k] > 0 ? lap : -lap;
  }
  return laps + ((w.cell->inside(w.position[s]) - point_).dot(normal_) > 0 ? 1 : 0);
}

/// Mass of a body times the number of planes passed since its last sample [kg].
double MassFlow::passed(const World& w, Slot s) {
  const int now = level(w, s), before = std::exchange(level_[static_cast<std::size_t>(w.id[s])], now);
  return before == unseen ? 0.0 : (now - before) / w.inverse_mass[s];
}

void MassFlow::bodies_come(const World& w, std::size_t first) {
  level_.resize(w.ids_given(), unseen);
  for (std::size_t s = first; s < w.size(); ++s)
    if (w.is_movable(static_cast<Slot>(s))) mass_ += passed(w, static_cast<Slot>(s));
}

void MassFlow::bodies_leave(const World& w, std::span<const BodyId> bodies) {
  level_.resize(w.ids_given(), unseen);
  for (const BodyId body : bodies)
    if (const Slot s = w.slot_of(body); s != no_slot && w.is_movable(s)) mass_ += passed(w, s);
}

void MassFlow::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  level_.resize(w.ids_given(), unseen);
  mass_ += block_sum<double>(level_.size(), [&](std::size_t id) {
    const Slot s = w.slot_of(static_cast<BodyId>(id));
    return s == no_slot || !w.is_movable(s) ? 0.0 : passed(w, s);
  });
  times_.push_back(w.time);
  masses_.push_back(mass_);
  std::size_t first = 0;  // the youngest sample at least a window old, or the oldest there is
  while (first + 1 < times_.size() && times_[first + 1] <= w.time - window_ * (1 - 1e-9)) ++first;
  times_.erase(times_.begin(), times_.begin() + static_cast<std::ptrdiff_t>(first));
  masses_.erase(masses_.begin(), masses_.begin() + static_cast<std::ptrdiff_t>(first));
  const double span = w.time - times_.front();
  values = {span > 0 ? (mass_ - masses_.front()) / span : 0.0, mass_};
}

void MassFlow::visit(StateVisitor& visitor, const std::string& prefix) {
  visitor.value(prefix + "/mass", mass_);
  visitor.column(prefix + "/level", level_);
  visitor.column(prefix + "/times", times_);
  visitor.column(prefix + "/masses", masses_);
}

}  // namespace epafi
