#include "ranks/halo.h"

#include <algorithm>
#include <cstring>

#include "engine/threads/parallel.h"
#include "ranks/communicator.h"
#include "ranks/shared_rows.h"

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

}  // namespace

std::size_t most_bytes_of_moving(World& world) {
  return std::max(bytes_of_moving(world, false), world.columns().states ? bytes_of_moving(world, true) : 0);
}

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

void Halo::set_up(World& world, std::vector<std::pair<int, Slot>> sends, const std::vector<std::uint32_t>& place) {
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
  shares_ = SharedRows::of_program().reserve(from_.size() * most_bytes_of_moving(world));
  if (!shares_) return;
  first_of_rank_.assign(static_cast<std::size_t>(rank_count()), 0);
  for (const Plan::Share& share : plan_.to_ranks())
    first_of_rank_[static_cast<std::size_t>(share.rank)] = static_cast<std::uint32_t>(share.begin);
  swap_numbers(first_of_rank_);
}

namespace {

/// What the states tell of a body, where no more of it changes, as each_moving has it: a call for each body took as
/// long as the messages.
struct StateRow {
  double position[3], velocity[3], spin[3], predicted[3];
  static bool is_all(World& world, bool by_states) {
    return by_states && bytes_of_moving(world, true) == sizeof(StateRow);
  }
  void write(const BodyState& s) {
    std::memcpy(position, &s.position, sizeof position);
    std::memcpy(velocity, &s.velocity, sizeof velocity);
    std::memcpy(spin, &s.spin, sizeof spin);
    std::memcpy(predicted, &s.predicted, sizeof predicted);
  }
  void read(BodyState& s) const {
    std::memcpy(&s.position, position, sizeof position);
    std::memcpy(&s.velocity, velocity, sizeof velocity);
    std::memcpy(&s.spin, spin, sizeof spin);
    std::memcpy(&s.predicted, predicted, sizeof predicted);
  }
};

/// f(state, row) for the bodies of these slots, which are far from each other in memory.
template <class Row, class F>
void each_state(World& world, std::span<const Slot> slots, Row* rows, const F& f) {
  constexpr std::size_t block = 1024, ahead = 12;
  BodyState* const states = world.states().data();
  parallel_blocks(slots.size(), block, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t k = begin; k < end; ++k) {
      const BodyState& soon = states[slots[std::min(k + ahead, slots.size() - 1)]];
      __builtin_prefetch(&soon);
      __builtin_prefetch(&soon.spin);
      f(states[slots[k]], rows[k]);
    }
  });
}

}  // namespace

void Halo::begin(World& world, bool by_states) {
  const std::size_t row = bytes_of_moving(world, by_states), size = from_.size() * row;
  if (!shares_) out_.resize(size);
  std::byte* const to = shares_ ? SharedRows::of_program().begin() : out_.data();
  if (StateRow::is_all(world, by_states))
    each_state(world, from_, reinterpret_cast<StateRow*>(to), [](const BodyState& s, StateRow& r) { r.write(s); });
  else
    parallel_for(from_.size(), [&](std::size_t k) { write_moving(world, by_states, from_[k], to + k * row); });
  if (shares_)
    SharedRows::of_program().tell();
  else
    plan_.begin(out_, row, in_);
  bytes_ += static_cast<double>(size);
}

void Halo::read(World& world, bool by_states, std::span<const Slot> into, const std::byte* rows) {
  const std::size_t row = bytes_of_moving(world, by_states);
  if (StateRow::is_all(world, by_states))
    each_state(world, into, reinterpret_cast<const StateRow*>(rows),
               [](BodyState& s, const StateRow& r) { r.read(s); });
  else
    parallel_for(into.size(), [&](std::size_t k) { read_moving(rows + k * row, by_states, into[k], world); });
}

void Halo::finish(World& world, bool by_states) {
  if (!shares_) {
    plan_.finish();
    return read(world, by_states, into_, in_.data());
  }
  const std::size_t row = bytes_of_moving(world, by_states);
  for (const Plan::Share& share : plan_.from_ranks()) {
    const std::size_t first = first_of_rank_[static_cast<std::size_t>(share.rank)];
    const std::byte* const rows = SharedRows::of_program().wait(share.rank) + first * row;
    read(world, by_states, std::span(into_).subspan(share.begin, share.end - share.begin), rows);
  }
}

}  // namespace epafi
