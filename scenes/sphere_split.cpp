#include "scenes/sphere_split.h"

#include <cmath>

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
  std::vector<double> radius(world.size(), SphereList::not_a_sphere);
  std::vector<std::int32_t> plane_of(world.size(), -1);
  SphereList list{pairs.pairs, radius, plane_of, {}, {}};
  bool alone = true;
  for (Slot s = 0; s < world.size(); ++s) {
    const ShapeRef ref{world.shape[s]};
    if (ref.type() == ShapeStore::type_of<Sphere>() && world.is_movable(s)) radius[s] = spheres[ref.index()].radius;
    alone = alone && (radius[s] > 0.0 || is_fixed(world, s));
    if (ref.type() != ShapeStore::type_of<HalfSpace>() || !is_fixed(world, s)) continue;
    plane_of[s] = static_cast<std::int32_t>(list.planes.size());
    list.planes.push_back({s, world.pose(s).orientation * planes[ref.index()].normal, world.position[s]});
  }
  rest_.pairs.clear();
  rest_.margin = pairs.margin, rest_.margins = pairs.margins, ++rest_.generation;
  for (const Pair& p : pairs.pairs)
    if (!list.takes(p)) rest_.pairs.push_back(p);
  if (alone) list.margins = pairs.margins;
  model_.set_pairs(world, list);
  known_ = true, generation_ = pairs.generation;
}

}  // namespace epafi
