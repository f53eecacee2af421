#include "viz_export/measures/wheelset_measure.h"

#include <algorithm>
#include <limits>

#include "detection/profiles/wheelset_on_track.h"

namespace epafi {

void WheelsetMeasure::sample(const StepView& view, std::vector<double>& values) {
  values.assign(12, std::numeric_limits<double>::quiet_NaN());
  const World& w = view.world;
  const Slot s = setup_.bodies[0].empty() ? no_slot : w.slot_of(setup_.bodies[0][0]);
  if (s == no_slot || ShapeRef{w.shape[s]}.type() != ShapeStore::type_of<WheelProfile>()) return;
  Slot rail = no_slot;
  for (Slot t = 0; t < w.size() && rail == no_slot; ++t)
    if (ShapeRef{w.shape[t]}.type() == ShapeStore::type_of<RailProfile>()) rail = t;
  if (rail == no_slot) return;
  const Wheelset& wheelset = *setup_.shapes->of<WheelProfile>()[ShapeRef{w.shape[s]}.index()].wheelset;
  const Track& track = *setup_.shapes->of<RailProfile>()[ShapeRef{w.shape[rail]}.index()].track;
  const PlaceOnTrack at = place_on_track(wheelset, track, w.pose(s), w.pose(rail));
  Vec3 left = Vec3::Zero(), right = Vec3::Zero();
  double contacts = 0.0;
  const ContactSet& c = view.contacts;
  for (std::size_t k = 0; k < c.size() && k < c.force.size(); ++k) {
    const bool first = c.a[k] == s && c.b[k] == rail, second = c.b[k] == s && c.a[k] == rail;
    if (!first && !second) continue;
    // the feature holds the wheel: 16 and above is the right one
    (c.feature[k] >= 16 ? right : left) += (first ? 1.0 : -1.0) * (at.frame.orientation.conjugate() * c.force[k]);
    if (!c.force[k].isZero()) contacts += 1.0;
  }
  values = {at.distance,        at.position.lateral_shift,
            at.position.height, at.position.yaw,
            at.position.roll,   left.x(),
            left.y(),           left.z(),
            right.x(),          right.y(),
            right.z(),          contacts};
}

void SwingMeasure::sample(const StepView& view, std::vector<double>& values) {
  std::vector<double> all;
  place_.sample(view, all);
  time_.push_back(view.world.time);
  lateral_.push_back(all[1]);
  std::size_t old = 0;
  while (time_[old] < view.world.time - window_) ++old;
  time_.erase(time_.begin(), time_.begin() + static_cast<std::ptrdiff_t>(old));
  lateral_.erase(lateral_.begin(), lateral_.begin() + static_cast<std::ptrdiff_t>(old));
  const auto [low, high] = std::minmax_element(lateral_.begin(), lateral_.end());
  values = {0.5 * (*high - *low)};
}

}  // namespace epafi
