#include "detection/broad/broad_phase.h"

#include "engine/parallel_order.h"

namespace epafi {

void ListBroadPhase::see_time(double now) {
  if (now > last_time_) step_time_ = now - last_time_;
  last_time_ = now;
}

bool ListBroadPhase::keeps_pairs(const World& world) {
  see_time(world.time);
  if (world.size() != bodies_.size()) valid_ = false;
  return valid_ && !bodies_.outdated(world);
}

void ListBroadPhase::find_pairs(const World& world, PairList& pairs) {
  if (keeps_pairs(world)) return;
  if (valid_) bodies_.learn(world, step_time_);
  bodies_.update(world, setup_, step_time_);
  collect(bodies_, collector_);
  collector_.finish(pairs.pairs);
  pairs.margin = bodies_.largest_margin(), parallel_copy(bodies_.margin, pairs.margins);
  ++pairs.generation;
  valid_ = true;
}

}  // namespace epafi
