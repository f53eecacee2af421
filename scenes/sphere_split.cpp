#include "scenes/sphere_split.h"

#include <cmath>

#include "engine/parallel_order.h"

namespace epafi {

void WornPairs::find_pairs(const World& world, PairList& pairs) {
  list_->find_pairs(world, pairs);
  wear_ = std::isfinite(way_) ? list_->bodies().wear(world) : infinity;  // a sum is of use where ways are known
}

bool WornPairs::keeps_pairs(const World& world) {
  list_->see_time(world.time);
  const auto* model = dynamic_cast<const FusedSpheres*>(pipeline_.contact_model.get());
  way_ = model ? model->largest_way() : infinity;
  wear_ += way_;
  return wear_ < 1.0 - 1e-6;  // sums are rounded
}

void SphereSplit::collide(const World& world, const PairList& pairs, ContactSet& contacts) {
  const bool fresh = !known_ || generation_ != pairs.generation || model_.waits_for_pairs();
  if (fresh) split(world, pairs);
  others_->collide(world, rest_, contacts);
  if (!fresh || rest_.pairs.empty()) return;
  watched_.clear();
  others_->looks_at(rest_, watched_);
  model_.watch(watched_);
}

void SphereSplit::split(const World& world, const PairList& pairs) {
  const auto& spheres = shapes_.of<Sphere>();
  const auto& planes = shapes_.of<HalfSpace>();
  UnwrittenColumn<double> radius(world.size());
  UnwrittenColumn<std::int32_t> plane_of(world.size());
  const auto slots = world.size();
  parallel_for(slots, [&](std::size_t s) {
    const ShapeRef ref{world.shape[s]};
    const bool free = ref.type() == ShapeStore::type_of<Sphere>() && world.is_movable(static_cast<Slot>(s));
    radius[s] = free ? spheres[ref.index()].radius : SphereList::not_a_sphere, plane_of[s] = -1;
  });
  const auto moves = [&](std::size_t s) { return !(radius[s] > 0.0) && !is_fixed(world, static_cast<Slot>(s)); };
  const bool alone = block_max<char>(slots, 0, [&](std::size_t s) { return static_cast<char>(moves(s)); }) == 0;
  SphereList list{pairs.pairs, radius, plane_of, {}, {}};
  const auto is_plane = [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    return ShapeRef{world.shape[s]}.type() == ShapeStore::type_of<HalfSpace>() && is_fixed(world, s);
  };
  const auto plane = [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    return SpherePlane{s, world.pose(s).orientation * planes[ShapeRef{world.shape[s]}.index()].normal,
                       world.position[s]};
  };
  parallel_select(world.size(), is_plane, plane, list.planes);
  for (std::size_t k = 0; k < list.planes.size(); ++k) plane_of[list.planes[k].slot] = static_cast<std::int32_t>(k);
  ++rest_.generation;
  parallel_select(
      pairs.pairs.size(), [&](std::size_t k) { return !list.takes(pairs.pairs[k]); },
      [&](std::size_t k) { return pairs.pairs[k]; }, rest_.pairs);
  if (!rest_.pairs.empty()) rest_.margin = pairs.margin, parallel_copy(pairs.margins, rest_.margins);
  if (alone) list.margins = pairs.margins;
  model_.set_pairs(world, list);
  known_ = true, generation_ = pairs.generation;
}

}  // namespace epafi
