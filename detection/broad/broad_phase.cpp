#include "detection/broad/broad_phase.h"

#include <algorithm>
#include <utility>

#include "detection/broad/periodic_pairs.h"
#include "engine/threads/parallel_order.h"

namespace epafi {

namespace {
constexpr std::size_t most_taken_in = 64;  // bodies at a time: each is tested against all others
}

void ListBroadPhase::see_time(double now) {
  if (now > last_time_) step_time_ = now - last_time_;
  last_time_ = now;
}

bool ListBroadPhase::keeps_pairs(const World& world) {
  see_time(world.time);
  if (world.size() != bodies_.bodies()) valid_ = known_ = false;
  if (!valid_) return false;
  const ListState used_up = bodies_.used_up(world);
  used_up_by_slow_ = used_up.by_slow;
  return !used_up.out;
}

bool ListBroadPhase::take_in(const World& world, PairList& pairs) {
  const std::size_t old = bodies_.bodies();
  if (!valid_ || world.size() <= old || world.size() > old + most_taken_in) return false;
  if (!bodies_.take_in(world, setup_, step_time_)) return false;
  collector_.add_behind(old, balls_.size(), pairs);
  if (!(setup_.margin > 0.0)) pairs.margin = std::max(pairs.margin, bodies_.largest_margin(old));
  pairs.inverse_half_margin = bodies_.inverse_half_margin;
  if (setup_.spheres.wanted) balls_.take_more(world, setup_, bodies_, pairs);
  ++pairs.generation;
  return true;
}

void ListBroadPhase::find_pairs(const World& world, PairList& pairs) {
  take_in(world, pairs);
  if (!keeps_pairs(world)) renew_pairs(world, pairs, used_up_by_slow_);
}

void ListBroadPhase::renew_pairs(const World& world, PairList& pairs, bool used_up_by_slow) {
  if (valid_) bodies_.learn(world, step_time_, used_up_by_slow);
  const bool same_bodies = std::exchange(known_, true);
  bodies_.update(world, setup_, step_time_, same_bodies);
  collect(bodies_, collector_);
  if (world.cell) {
    collector_.finish(found_);
    name_images(world, bodies_.images, found_, pairs.pairs);
    if (setup_.spheres.wanted) take_spheres(world, setup_.spheres, pairs);
  } else {
    collector_.finish(pairs.pairs);
    if (setup_.spheres.wanted) collector_.finish(pairs.spheres);
  }
  name_margins(pairs);
  if (setup_.spheres.wanted) balls_.take(world, setup_, bodies_, same_bodies, pairs);
  ++pairs.generation;
  valid_ = true;
}

void ListBroadPhase::name_margins(PairList& pairs) const {
  pairs.margin = setup_.margin > 0.0 ? setup_.margin : bodies_.largest_margin();
  pairs.inverse_half_margin = bodies_.inverse_half_margin;
}

}  // namespace epafi
