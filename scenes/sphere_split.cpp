#include "scenes/sphere_split.h"

#include <algorithm>

#include "engine/state/large_column.h"
#include "engine/threads/parallel_order.h"

namespace epafi {

namespace {
constexpr double nearly = 1.0 - 1e-6;  // of a margin: sums are rounded
}

void BlockBoundPairs::find_pairs(const World& world, PairList& pairs) {
  const bool grown = list_->take_in(world, pairs);
  const std::uint64_t before = pairs.generation;
  const bool measured = grown && list_->bodies().are_round();  // one pass for both
  if (measured)
    used_up_ = measure(world);
  else if (!used_up_.out && !list_->keeps_pairs(world))
    used_up_ = {true, list_->used_up_by_slow()};
  if (used_up_.out) {
    if (FusedSpheres* const m = model()) m->forget_margins();
    list_->renew_pairs(world, pairs, used_up_.by_slow);
  }
  used_up_ = {};
  if (!measured) used_margin_.clear();
  const bool fresh = pairs.generation != before;
  if (!fresh && !displacements_known_ && !grown) return;  // how much of the margin is used is not known then
  if (FusedSpheres* const m = model()) m->expect(list_->bodies().common_motion(world.time));
  if (fresh)
    used_margin_.assign(blocks(world), 0.0);
  else if (!measured)
    measure(world);
}

std::size_t BlockBoundPairs::block_size() const {
  return model() ? model()->block_size() : SphereBlocks::largest_block;
}

std::size_t BlockBoundPairs::blocks(const World& world) const {
  return (world.size() + block_size() - 1) / block_size();
}

/// Computes used_margin_ from the positions of bodies.
ListState BlockBoundPairs::measure(const World& world) {
  const FatBodies& bodies = list_->bodies();
  const auto at = [&](std::size_t s) -> const Vec3& { return world.position[s]; };
  const ListFrame now = bodies.frame(world);
  std::vector<MarginUse>& found = block_results<MarginUse>(blocks(world), MarginUse{});
  parallel_blocks(world.size(), block_size(), [&](std::size_t begin, std::size_t end, std::size_t b) {
    found[b] = bodies.used_margin(begin, end, at, now);
  });
  ListState state{bodies.plane_use(world, now) > 1.0, false};
  used_margin_.resize(found.size());
  for (std::size_t b = 0; b < found.size(); ++b) {
    used_margin_[b] = found[b].most - now.strain_use;
    state += found[b].used_up;
  }
  return state;
}

/// True where the bounds so far hold in this step: no body was wrapped in a periodic cell. The bounds are scaled by the
/// growth of the cell.
bool BlockBoundPairs::keep_bounds(const World& world) {
  if (!world.cell) return true;
  if (wraps_ != world.wraps) {
    wraps_ = world.wraps;
    return false;
  }
  const Vec3 before = std::exchange(cell_size_, world.cell->size);
  if (before == world.cell->size) return true;
  if (before.isZero()) return false;
  const double growth = std::max(1.0, world.cell->size.cwiseQuotient(before).maxCoeff());
  for (double& used_margin : used_margin_) used_margin *= growth;
  return true;
}

/// Predicts the end of the list from displacements as long as in this step. True where it ends now, together with the
/// lists of other processes.
bool BlockBoundPairs::ends_with_others(std::span<const double> displacements, double strain_use,
                                       const ListState& nearly_used_up) {
  double used = strain_use, next = used;
  for (std::size_t b = 0; b < displacements.size(); ++b) {
    used = std::max(used, used_margin_[b] + strain_use);
    next = std::max(next, used_margin_[b] + displacements[b] + strain_use);
  }
  predicted_ = {next >= nearly, nearly_used_up.by_slow};
  if (!theirs_.comes || !(used > 0.5)) return false;
  used_up_ = {true, theirs_.by_slow};
  return true;
}

bool BlockBoundPairs::keeps_pairs(const World& world) {
  list_->see_time(world.time);
  predicted_ = {};
  const std::span<const double> displacements = model() ? model()->largest_displacements() : std::span<const double>{};
  displacements_known_ = !displacements.empty() && list_->bodies().bodies() == world.size();
  const bool known = keep_bounds(world);
  if (!known || !displacements_known_ || used_margin_.size() != displacements.size()) {
    used_margin_.clear();
    return false;
  }
  used_up_ = {};
  doubtful_.clear();
  const FatBodies& bodies = list_->bodies();
  const ListFrame now = bodies.frame(world);
  // bounds miss the flow of the cell past held bodies, and past a drifting frame
  const bool all = now.flows() && (bodies.holds_bounded() || !now.common.isZero(0.0));
  const double more = world.owner.empty() ? 0.0 : 1.0;  // of several processes the next step is predicted
  for (std::size_t b = 0; b < displacements.size(); ++b)
    if ((used_margin_[b] += displacements[b]) + more * displacements[b] + now.strain_use >= nearly || all)
      doubtful_.push_back(b);
  const auto at = [&](std::size_t s) -> const Vec3& { return world.position[s]; };
  std::vector<MarginUse>& found = block_results<MarginUse>(doubtful_.size(), MarginUse{});
  parallel_for(
      doubtful_.size(),
      [&](std::size_t k) {
        const std::size_t begin = doubtful_[k] * model()->block_size();
        const std::size_t end = std::min(begin + model()->block_size(), world.size());
        const double limit = world.owner.empty() ? 1.0 : nearly - displacements[doubtful_[k]];
        found[k] = bodies.used_margin(begin, end, at, now, limit);
        used_margin_[doubtful_[k]] = found[k].most - now.strain_use;
      },
      1);
  const double planes = bodies.plane_use(world, now);
  used_up_.out = planes > 1.0;
  bool keeps = planes < nearly;
  ListState nearly_used_up;
  for (const MarginUse& w : found) {
    used_up_.out = used_up_.out || w.most > 1.0;
    nearly_used_up += w.used_up;
    keeps = keeps && w.most < nearly;
  }
  used_up_.by_slow = nearly_used_up.by_slow;
  if (keeps && !world.owner.empty()) keeps = !ends_with_others(displacements, now.strain_use, nearly_used_up);
  theirs_ = {};
  return keeps;
}

void SphereSplit::collide(const World& world, const PairList& pairs, ContactSet& contacts) {
  if (!known_ || generation_ != pairs.generation || model_.waits_for_pairs()) split(world, pairs);
  others_->collide(world, pairs, contacts);
}

void SphereSplit::split(const World& world, const PairList& pairs) {
  const auto& planes = shapes_.of<HalfSpace>();
  SphereList list{pairs.spheres, {}, {}, !pairs.pairs.empty()};
  for (const Slot s : pairs.spheres.planes)
    list.planes.push_back({s, world.material[s],
                           world.pose(s).orientation * planes[ShapeRef{world.shape[s]}.index()].normal,
                           world.position[s]});
  if (!known_ || bodies_ != world.size()) read_bodies(world, known_ && bodies_ < world.size() ? bodies_ : 0);
  list.balls = balls_;
  if (alone_) list.inverse_half_margin = pairs.inverse_half_margin;
  model_.set_pairs(world, list);
  known_ = true;
  generation_ = pairs.generation;
  bodies_ = world.size();
}

/// Reads spheres from slot `first` on; the others are known.
void SphereSplit::read_bodies(const World& world, std::size_t first) {
  const auto& spheres = shapes_.of<Sphere>();
  const std::size_t count = world.size() - first;
  UnwrittenColumn<double> radius(count);
  parallel_for(count, [&](std::size_t i) {
    const auto s = static_cast<Slot>(first + i);
    const bool free = roles_.of(world, s) == SphereRole::sphere;
    radius[i] = free ? spheres[ShapeRef{world.shape[s]}.index()].radius : 0.0;
  });
  const bool others = block_max<char>(count, 0, [&](std::size_t i) {
                        const auto s = static_cast<Slot>(first + i);
                        const bool sphere = radius[i] > 0.0;
                        const bool plane = ShapeRef{world.shape[s]}.type() == ShapeStore::type_of<HalfSpace>();
                        return static_cast<char>(!sphere && !plane && !roles_.is_fixed(world, s));
                      }) != 0;
  alone_ = !others && (first == 0 || alone_);
  const bool only_spheres = std::ranges::all_of(radius, [](double r) { return r > 0.0; });
  model_.set_bodies(std::move(radius), first);
  if (first == 0 || !only_spheres) balls_ = find_balls(world, shapes_, roles_);
}

}  // namespace epafi
