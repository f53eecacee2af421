#include "ranks/halo.h"

#include <algorithm>
#include <cstring>

#include "engine/threads/parallel.h"

namespace epafi {

namespace {

/// Calls f(column) for all columns that a step changes; one element per body.
template <class F>
void each_moving(World& world, bool by_states, const F& f) {
  const bool rotates = world.rotates();
  if (by_states) {
    f(world.states());
  } else {
    f(world.position);
    f(world.velocity);
    if (rotates) f(world.angular_velocity);
    if (world.columns().force) f(world.force);
    if (world.columns().force && rotates) f(world.torque);
  }
  if (world.columns().periodic) f(world.wraps);
  if (world.has_orientation()) f(world.orientation);
  if (rotates && world.columns().anisotropy) f(world.angular_momentum);
}

}  // namespace

std::size_t bytes_of_moving(World& world, bool by_states) {
  std::size_t bytes = 0;
  each_moving(world, by_states, [&](auto&& column) { bytes += sizeof(column[0]); });
  return bytes;
}

void write_moving(World& world, bool by_states, Slot s, std::byte* to) {
  each_moving(world, by_states, [&](auto&& column) {
    std::memcpy(to, static_cast<const void*>(&column[s]), sizeof(column[0]));
    to += sizeof(column[0]);
  });
}

void read_moving(const std::byte* from, bool by_states, Slot s, World& world) {
  each_moving(world, by_states, [&](auto&& column) {
    std::memcpy(static_cast<void*>(&column[s]), from, sizeof(column[0]));
    from += sizeof(column[0]);
  });
}

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

void Halo::begin(World& world, bool by_states) {
  const std::size_t row = bytes_of_moving(world, by_states);
  out_.resize(from_.size() * row);
  parallel_for(from_.size(), [&](std::size_t k) { write_moving(world, by_states, from_[k], out_.data() + k * row); });
  plan_.begin(out_, row, in_);
  bytes_ += static_cast<double>(out_.size());
}

void Halo::finish(World& world, bool by_states) {
  const std::size_t row = bytes_of_moving(world, by_states);
  plan_.finish();
  parallel_for(into_.size(), [&](std::size_t k) { read_moving(in_.data() + k * row, by_states, into_[k], world); });
}

}  // namespace epafi
