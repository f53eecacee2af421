#include "ranks/halo.h"

#include <algorithm>
#include <cstring>

#include "engine/threads/parallel.h"

namespace epafi {

namespace {

/// Calls f(address of a slot's element, bytes) for all columns that a step changes.
template <class F>
void each_moving(World& world, bool by_states, const F& f) {
  const bool rotates = world.rotates();
  const auto column = [&](auto&& all) { f([&](Slot s) { return static_cast<void*>(&all[s]); }, sizeof(all[0])); };
  if (by_states) {
    BodyState* const states = world.states().data();
    for (const auto part : {&BodyState::position, &BodyState::velocity, &BodyState::spin, &BodyState::predicted})
      f([&](Slot s) { return static_cast<void*>(&(states[s].*part)); }, 3 * sizeof(double));  // the fourth is constant
  } else {
    column(world.position);
    column(world.velocity);
    if (rotates) column(world.angular_velocity);
    if (world.columns().force) column(world.force);
    if (world.columns().force && rotates) column(world.torque);
  }
  if (world.columns().periodic) column(world.wraps);
  if (world.has_orientation()) column(world.orientation);
  if (rotates && world.columns().anisotropy) column(world.angular_momentum);
}

/// Asks for the state of a body that is soon read: bodies at a border are far from each other in memory.
void ask_for(const World& world, const std::vector<Slot>& slots, std::size_t k) {
  constexpr std::size_t ahead = 8;
  if (!world.columns().states || k + ahead >= slots.size()) return;
  const BodyState& soon = world.states()[slots[k + ahead]];
  __builtin_prefetch(&soon);
  __builtin_prefetch(&soon.spin);
}

}  // namespace

std::size_t bytes_of_moving(World& world, bool by_states) {
  std::size_t sum = 0;
  each_moving(world, by_states, [&](const auto&, std::size_t bytes) { sum += bytes; });
  return sum;
}

void write_moving(World& world, bool by_states, Slot s, std::byte* to) {
  each_moving(world, by_states, [&](const auto& address, std::size_t bytes) {
    std::memcpy(to, address(s), bytes);
    to += bytes;
  });
}

void read_moving(const std::byte* from, bool by_states, Slot s, World& world) {
  each_moving(world, by_states, [&](const auto& address, std::size_t bytes) {
    std::memcpy(address(s), from, bytes);
    from += bytes;
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
  parallel_for(from_.size(), [&](std::size_t k) {
    ask_for(world, from_, k);
    write_moving(world, by_states, from_[k], out_.data() + k * row);
  });
  plan_.begin(out_, row, in_);
  bytes_ += static_cast<double>(out_.size());
}

void Halo::finish(World& world, bool by_states) {
  const std::size_t row = bytes_of_moving(world, by_states);
  plan_.finish();
  parallel_for(into_.size(), [&](std::size_t k) {
    ask_for(world, into_, k);
    read_moving(in_.data() + k * row, by_states, into_[k], world);
  });
}

}  // namespace epafi
