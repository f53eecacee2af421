#include "detection/broad/periodic_pairs.h"

#include <algorithm>
#include <tuple>

#include "engine/error.h"
#include "engine/parallel.h"

namespace epafi {

PeriodicPairs::PeriodicPairs(BroadSetup setup, std::unique_ptr<BroadPhase> inner)
    : setup_(std::move(setup)), inner_(std::move(inner)), list_(dynamic_cast<ListBroadPhase*>(inner_.get())) {
  EPAFI_REQUIRE(list_ != nullptr, "images need a broad phase that keeps a list");
}

/// What a body reaches until the list is built anew: fattened by (reach + margin)/2, the margin at most half its
/// radius.
double PeriodicPairs::fat_radius(const World& world, Slot s) const {
  const double r = setup_.shapes->bounding_radius({world.shape[s]});
  return r + 0.5 * (setup_.reach + std::max(setup_.margin, 0.5 * r));
}

void PeriodicPairs::choose_images(const World& world) {
  const PeriodicCell& cell = *world.cell;
  Vec3 low = Vec3::Constant(infinity), high = -low;
  double largest = 0.0;  // an image's margin is that of a held body: up to half the largest radius of a free one
  for (Slot s = 0; s < world.size(); ++s) {
    if (!world.position[s].allFinite()) continue;
    const double r = fat_radius(world, s);
    if (!std::isfinite(r)) continue;
    low = low.cwiseMin(world.position[s] - Vec3::Constant(r)),
    high = high.cwiseMax(world.position[s] + Vec3::Constant(r));
    if (world.is_movable(s)) largest = std::max(largest, r);
  }
  images_.clear();
  const auto span = [&](std::size_t k) { return cell.repeats[k] ? 1 : 0; };
  for (Slot s = 0; s < world.size(); ++s) {
    const double r = fat_radius(world, s) + 0.25 * largest;
    if (!std::isfinite(r) || !world.position[s].allFinite()) continue;
    for (int i = -span(0); i <= span(0); ++i)
      for (int j = -span(1); j <= span(1); ++j)
        for (int k = -span(2); k <= span(2); ++k) {
          if (i == 0 && j == 0 && k == 0) continue;
          const Vec3 x = world.position[s] + cell.shift(image_code(i, j, k));
          if (((x - low).array() > -r).all() && ((high - x).array() > -r).all()) images_.push_back({s, {i, j, k}});
        }
  }
}

/// Copies where the bodies are, and their images: all that tells whether the list still holds.
void PeriodicPairs::follow(const World& world) {
  const std::size_t n = world.size();
  shown_.time = world.time;
  parallel_for(shown_.size(), [&](std::size_t i) {
    shown_.position[i] = i < n ? world.position[i] : place_of(world, images_[i - n]);
    if (world.has_orientation()) shown_.orientation[i] = world.orientation[of(world, i)];
  });
}

/// Copies all else that a broad phase reads to make a list.
void PeriodicPairs::show(const World& world) {
  const std::size_t n = world.size(), all = n + images_.size();
  shown_.id.resize(all), shown_.shape.resize(all), shown_.inverse_mass.resize(all);
  shown_.position.resize(all), shown_.velocity.resize(all);
  if (world.rotates()) shown_.angular_velocity.resize(all);
  if (world.has_orientation()) shown_.orientation.resize(all);
  parallel_for(all, [&](std::size_t i) {
    const bool real = i < n;
    const Slot s = of(world, i);
    shown_.velocity[i] = world.velocity[s];
    if (world.rotates()) shown_.angular_velocity[i] = world.angular_velocity[s];
    shown_.id[i] = real ? world.id[s] : static_cast<BodyId>(world.ids_given() + (i - n));
    shown_.shape[i] = world.shape[s], shown_.inverse_mass[i] = real ? world.inverse_mass[s] : 0.0;
  });
  follow(world);
}

void PeriodicPairs::translate(const World& world, PairColumn& pairs) const {
  const std::size_t n = world.size();
  pairs.clear();
  const auto add = [&](Slot a, Slot b, const Wraps& step) {
    const std::uint32_t key = image_code(step + world.wraps[a] - world.wraps[b]);
    pairs.push_back({a, b, image_code(step) | key << 8});
  };
  for (const Pair& p : found_.pairs) {
    if (p.a < n && p.b < n) {
      add(p.a, p.b, Wraps::Zero());
      continue;
    }
    const Slot real = p.a < n ? p.a : p.b;  // an image never meets an image
    const Image& image = images_[(p.a < n ? p.b : p.a) - n];
    const bool in_order = world.id[real] < world.id[image.of];
    // two free bodies meet as (i, image of j) and as (j, image of i): the first stands for both. A body meets its own
    // image only in a cell that is too small, which is refused before.
    if (world.is_movable(image.of) && !in_order) continue;
    if (in_order)
      add(real, image.of, image.step);
    else
      add(image.of, real, -image.step);
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) {
    return std::tuple(p.a, p.b, p.image >> 8) < std::tuple(q.a, q.b, q.image >> 8);
  });
}

void PeriodicPairs::find_pairs(const World& world, PairList& pairs) {
  const bool same = shown_.rotates() == world.rotates() && shown_.has_orientation() == world.has_orientation();
  if (!same)
    shown_ = World(Columns{.rotation = world.rotates(), .orientation = world.has_orientation()}), valid_ = false;
  if (valid_ && shown_.size() != world.size() + images_.size()) valid_ = false;
  if (valid_) {
    follow(world);
    if (list_->keeps_pairs(shown_)) return;
  }
  choose_images(world);
  show(world);
  valid_ = true;
  inner_->reorder({});
  inner_->find_pairs(shown_, found_);
  translate(world, pairs.pairs);
  if (setup_.spheres.wanted) take_spheres(world, setup_.spheres, pairs);
  pairs.margin = found_.margin;  // an image has its own, which its body does not know
  ++pairs.generation;
}

}  // namespace epafi
