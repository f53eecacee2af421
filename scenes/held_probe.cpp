#include "scenes/held_probe.h"

#include <algorithm>

namespace epafi {

namespace {

constexpr double probe_rounding = 1e-9;  // of the body's radius: what is placed to touch may overlap by some ulp

/// Calls f(shift, code) for the body itself and its nearest images.
template <class F>
void each_cell_image(const std::optional<PeriodicCell>& cell, const F& f) {
  const auto span = [&](std::size_t k) { return cell && cell->repeats[k] ? 1 : 0; };
  for (int i = -span(0); i <= span(0); ++i)
    for (int j = -span(1); j <= span(1); ++j)
      for (int k = -span(2); k <= span(2); ++k) {
        const std::uint32_t code = image_code(i, j, k);
        f(cell ? cell->shift(code) : Vec3(Vec3::Zero()), code);
      }
}

Aabb moved_box(const Aabb& box, const Vec3& by) { return {box.min + by, box.max + by}; }

}  // namespace

bool HeldProbe::is_near(const World& world, Slot s, const Aabb& box) const {
  const ShapeRef ref{world.shape[s]};
  if (ref.type() == ShapeStore::type_of<HalfSpace>()) {
    const Vec3 normal = world.pose(s).orientation * shapes_.of<HalfSpace>()[ref.index()].normal;
    const Vec3 deepest = (normal.array() > 0).select(box.min, box.max);
    return (deepest - world.position[s]).dot(normal) < -probe_rounding * box.extent().norm();
  }
  const Aabb own = shapes_.bounding_box(world, s);
  bool near = false;
  each_cell_image(world.cell,
                  [&](const Vec3& shift, std::uint32_t) { near = near || moved_box(own, shift).overlaps(box); });
  return near;
}

void HeldProbe::look(const World& world, const Vec3& low, const Vec3& high) {
  world_ = World(world_.columns());
  world_.cell = world.cell;
  world_.add({});
  boxes_.clear();
  narrow_phase_.reorder({});
  const Aabb box{low, high};
  for (Slot s = 0; s < world.size(); ++s) {
    if (world.is_movable(s) || !is_near(world, s, box)) continue;
    const Pose pose = world.pose(s);
    world_.add({.position = pose.position, .orientation = pose.orientation, .shape = world.shape[s]});
    boxes_.push_back(shapes_.bounding_box({world.shape[s]}, pose));
  }
}

void HeldProbe::list_pairs(const Aabb& box) {
  pairs_.pairs.clear();
  ++pairs_.generation;
  for (Slot s = 0; s < boxes_.size(); ++s)
    each_cell_image(world_.cell, [&](const Vec3& shift, std::uint32_t code) {
      if (moved_box(boxes_[s], shift).overlaps(box)) pairs_.pairs.push_back({0, s + 1, code});
    });
}

bool HeldProbe::meets(const Body& body) {
  if (sees_nothing()) return false;
  world_.position[0] = body.position;
  world_.orientation[0] = body.orientation.normalized();
  world_.shape[0] = body.shape;
  list_pairs(shapes_.bounding_box({body.shape}, world_.pose(0)));
  if (pairs_.pairs.empty()) return false;
  narrow_phase_.collide(world_, pairs_, contacts_);
  const double allowed = probe_rounding * shapes_.bounding_radius({body.shape});
  return std::any_of(contacts_.gap.begin(), contacts_.gap.end(), [&](double gap) { return gap < -allowed; });
}

}  // namespace epafi
