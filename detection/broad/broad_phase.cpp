#include "detection/broad/broad_phase.h"

namespace epafi {

bool ListBroadPhase::keeps_pairs(const World& world) {
  if (world.time > last_time_) step_time_ = world.time - last_time_;
  last_time_ = world.time;
  if (world.size() != bodies_.size()) valid_ = false;
  return valid_ && !bodies_.outdated(world);
}

void ListBroadPhase::find_pairs(const World& world, PairList& pairs) {
  if (keeps_pairs(world)) return;
  bodies_.update(world, setup_, step_time_);
  collect(bodies_, collector_);
  collector_.finish(pairs.pairs);
  pairs.margin = bodies_.largest_margin(), pairs.margins = bodies_.margin;
  ++pairs.generation;
  valid_ = true;
}

}  // namespace epafi
