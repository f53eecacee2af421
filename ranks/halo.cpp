#include "ranks/halo.h"

#include <algorithm>
#include <cstring>

#include "engine/threads/parallel.h"

namespace epafi {

namespace {

/// Calls f(column) for all columns that a step changes; one element per body.
template <class F>
void each_moving(World& world, const F& f) {
  f(world.position);
  f(world.velocity);
  if (world.columns().force) f(world.force);
  if (world.columns().periodic) f(world.wraps);
  if (!world.rotates()) return;
  f(world.angular_velocity);
  if (world.columns().force) f(world.torque);
  if (world.columns().orientation) f(world.orientation);
  if (world.columns().anisotropy) f(world.angular_momentum);
}

std::size_t row_of(World& world) {
  std::size_t bytes = 0;
  each_moving(world, [&](auto& column) { bytes += sizeof(column[0]); });
  return bytes;
}

}  // namespace

void Halo::set_up(const World& world, std::vector<std::pair<int, Slot>> sends,
                  const std::vector<std::uint32_t>& place) {
  std::ranges::sort(sends);
  std::vector<int> ranks;
  from_.clear();
  for (const auto& [rank, slot] : sends) {
    ranks.push_back(rank);
    from_.push_back(slot);
  }
  plan_ = Plan(ranks);
  out_.resize(from_.size() * sizeof(std::uint32_t));
  for (std::size_t k = 0; k < from_.size(); ++k)
    std::memcpy(out_.data() + k * sizeof(std::uint32_t), &place[from_[k]], sizeof(std::uint32_t));
  plan_.run(out_, sizeof(std::uint32_t), in_);
  into_.resize(plan_.received());
  for (std::size_t k = 0; k < into_.size(); ++k) {
    std::uint32_t wanted = 0;
    std::memcpy(&wanted, in_.data() + k * sizeof wanted, sizeof wanted);
    const auto at = std::ranges::lower_bound(place, wanted);
    into_[k] = static_cast<Slot>(at - place.begin());
    if (at == place.end() || *at != wanted || world.owner[into_[k]] != World::elsewhere)
      throw std::logic_error("a ghost came to a rank that has no place for it");
  }
  const auto others = std::ranges::count(world.owner, std::uint8_t{World::elsewhere});
  if (static_cast<std::size_t>(others) != into_.size()) throw std::logic_error("a ghost has no owner");
}

void Halo::begin(World& world) {
  const std::size_t row = row_of(world);
  out_.resize(from_.size() * row);
  parallel_for(from_.size(), [&](std::size_t k) {
    std::byte* to = out_.data() + k * row;
    each_moving(world, [&](auto& column) {
      std::memcpy(to, static_cast<const void*>(&column[from_[k]]), sizeof(column[0]));
      to += sizeof(column[0]);
    });
  });
  plan_.begin(out_, row, in_);
  bytes_ += static_cast<double>(out_.size());
}

void Halo::finish(World& world) {
  const std::size_t row = row_of(world);
  plan_.finish();
  parallel_for(into_.size(), [&](std::size_t k) {
    const std::byte* from = in_.data() + k * row;
    each_moving(world, [&](auto& column) {
      std::memcpy(static_cast<void*>(&column[into_[k]]), from, sizeof(column[0]));
      from += sizeof(column[0]);
    });
  });
}

}  // namespace epafi
