#include "viz_export/measures/body_measures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/threads/parallel.h"

namespace epafi {

namespace {
struct Weighed {
  Vec3 sum = Vec3::Zero();
  double weight = 0.0;
  Weighed& operator+=(const Weighed& o) {
    sum += o.sum;
    weight += o.weight;
    return *this;
  }
};

/// Largest of several displacements: horizontal and downward [m].
struct Farthest {
  double distance = 0.0, sag = 0.0;
  Farthest& operator+=(const Farthest& o) {
    distance = std::max(distance, o.distance);
    sag = std::max(sag, o.sag);
    return *this;
  }
};
}  // namespace

Vec3 mean_over(const World& world, const BodyIds& bodies, const std::function<Vec3(Slot)>& of) {
  const Weighed all = block_sum<Weighed>(bodies.size(), [&](std::size_t k) -> Weighed {
    const Slot s = world.slot_of(bodies[k]);
    if (s == no_slot) return {};
    const double w = world.is_movable(s) ? 1.0 / world.inverse_mass[s] : 1.0;
    return {w * of(s), w};
  });
  return all.sum / all.weight;  // NaN when all are gone
}

void BodyMeasure::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  const Vec3 v = mean_over(w, setup_.bodies[0], [&](Slot s) -> Vec3 {
    if (quantity_ == BodyQuantity::position) return w.unwrapped(s);
    if (quantity_ == BodyQuantity::velocity) return w.velocity[s];
    return w.rotates() ? w.angular_velocity[s] : Vec3(Vec3::Zero());
  });
  values = {v.x(), v.y(), v.z()};
}

void ForceMeasure::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  std::vector<char> mine(w.size(), 0);
  for (std::size_t k = 0; k < setup_.bodies[0].size(); ++k)
    if (const Slot s = w.slot_of(setup_.bodies[0][k]); s != no_slot) mine[s] = 1;
  const ContactSet c = view.pieces().wanted([&](Slot a, Slot b) { return mine[a] != mine[b]; });
  const Vec3 sum = block_sum<Weighed>(c.size(), [&](std::size_t k) {
                     return Weighed{(mine[c.a[k]] - mine[c.b[k]]) * c.force[k]};
                   }).sum;
  values = {sum.x(), sum.y(), sum.z()};
}

/// World position of a point fixed to the reference body; the point itself where there is none.
Vec3 DriftMeasure::carried(const World& w, const Vec3& place) const {
  const Slot reference = reference_in(w);
  if (reference == no_slot) return place;
  const Vec3 turned = w.has_orientation() ? Vec3(w.orientation[reference] * place) : place;
  return w.unwrapped(reference) + turned;
}

/// Inverse of carried(): a world position in the frame of the reference body.
Vec3 DriftMeasure::seen(const World& w, const Vec3& place) const {
  const Slot reference = reference_in(w);
  if (reference == no_slot) return place;
  const Vec3 away = place - w.unwrapped(reference);
  return w.has_orientation() ? Vec3(w.orientation[reference].conjugate() * away) : away;
}

Slot DriftMeasure::reference_in(const World& w) const {
  return setup_.bodies.size() > 1 && setup_.bodies[1].size() > 0 ? w.slot_of(setup_.bodies[1][0]) : no_slot;
}

void DriftMeasure::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  const auto& bodies = setup_.bodies[0];
  const bool relative = setup_.bodies.size() > 1 && setup_.bodies[1].size() > 0;
  if (relative && reference_in(w) == no_slot) {  // it is gone: there is nothing to be seen from
    values.assign(2, std::numeric_limits<double>::quiet_NaN());
    return;
  }
  if (start_.empty()) start_.assign(bodies.size(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  const Vec3 up = w.gravity.squaredNorm() > 0 ? Vec3(-w.gravity.normalized()) : Vec3::UnitZ();
  const Farthest all = block_sum<Farthest>(bodies.size(), [&](std::size_t k) -> Farthest {
    const Slot s = w.slot_of(bodies[k]);
    if (s == no_slot) return {};
    if (!start_[k].allFinite()) start_[k] = seen(w, w.unwrapped(s));  // when it is seen first
    const Vec3 moved = w.unwrapped(s) - carried(w, start_[k]);
    const double rise = moved.dot(up);
    return {(moved - rise * up).norm(), -rise};
  });
  values = {all.distance, all.sag};
}

}  // namespace epafi
