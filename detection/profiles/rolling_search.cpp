#include "detection/profiles/rolling_search.h"

namespace epafi {

void RollingSearch::split(const World& world, const PairList& pairs) {
  rest_.pairs.clear();
  rolling_.clear();
  rest_.margin = pairs.margin;
  rest_.inverse_half_margin = pairs.inverse_half_margin;
  ++rest_.generation;
  const auto type = [&](Slot s) { return ShapeRef{world.shape[s]}.type(); };
  constexpr auto wheel = ShapeStore::type_of<WheelProfile>(), rail = ShapeStore::type_of<RailProfile>();
  for (const Pair& p : pairs.pairs) {
    if (type(p.a) == wheel && type(p.b) == rail)
      rolling_.emplace_back(p.a, p.b);
    else if (type(p.a) == rail && type(p.b) == wheel)
      rolling_.emplace_back(p.b, p.a);
    else
      rest_.pairs.push_back(p);
  }
  searches_.clear();
  for (const auto& [w, t] : rolling_) {
    const ShapeRef a{world.shape[w]}, b{world.shape[t]};
    searches_[{a.packed, b.packed}].emplace_back(*shapes_.of<WheelProfile>()[a.index()].wheelset,
                                                 *shapes_.of<RailProfile>()[b.index()].track);
  }
  known_ = true;
  generation_ = pairs.generation;
}

void RollingSearch::collide(const World& world, const PairList& pairs, ContactSet& contacts) {
  if (!known_ || generation_ != pairs.generation) split(world, pairs);
  others_->collide(world, rest_, contacts);
  regions_.all.clear();
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> used;
  for (const auto& [w, t] : rolling_) {
    const std::pair key{world.shape[w], world.shape[t]};
    const std::size_t first = regions_.all.size();
    searches_[key][used[key]++].find(world.pose(w), world.pose(t), 0.0, true, regions_.all);
    for (std::size_t k = first; k < regions_.all.size(); ++k) {
      regions_.all[k].wheelset = w;
      regions_.all[k].track = t;
    }
  }
}

}  // namespace epafi
