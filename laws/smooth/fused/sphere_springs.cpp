#include "laws/smooth/fused/sphere_springs.h"

#include <algorithm>

namespace epafi {

namespace {
/// A sixteenth and 64 places are free: the row of a block moves to the end of its column every sixteenth step.
constexpr std::size_t room_for(std::size_t count) { return count + count / 16 + 64; }
}  // namespace

void SphereSprings::grow(std::size_t size) {
  each_column([size]<class T>(UnwrittenColumn<T>& column) {
    const bool begins = column.empty();
    column.reserve(size), column.resize(size);
    if (begins) column[unloaded] = T{};
  });
}

/// Those from `place` on.
void SphereSprings::move_up(std::uint32_t place, std::uint32_t by) {
  each_column([&](auto& column) {
    std::copy_backward(column.begin() + place, column.begin() + last_, column.begin() + last_ + by);
  });
  last_ += by;
}

void SphereSprings::move_to_end() {
  const auto size = static_cast<std::uint32_t>(friction_.size());
  const std::uint32_t by = size - last_;
  move_up(first_, by), first_ += by;
}

SphereSprings::Places SphereSprings::begin_step() {
  if (first_ < unloaded + 1 + lead) {
    if (friction_.size() < room_for(count()) - count() / 32) grow(room_for(count()));
    move_to_end();
  }
  return {first_, first_ - lead};
}

std::uint32_t SphereSprings::make_room(std::uint32_t place) {
  constexpr std::uint32_t by = 4 * lead;
  if (friction_.size() < last_ + by) grow(last_ + by + (last_ - first_) / 8);
  move_up(place, by);
  return by;
}

void SphereSprings::choose(std::span<const std::uint32_t> from) {
  bool all = from.size() == count();
  for (std::size_t k = 0; all && k < from.size(); ++k) all = from[k] == k;
  if (all) return;
  const auto size = static_cast<std::uint32_t>(from.size());
  const std::size_t room = std::max(friction_.size(), room_for(size));
  each_column([&]<class T>(UnwrittenColumn<T>& column) {
    UnwrittenColumn<T> chosen(room);
    chosen[unloaded] = T{};
    for (std::uint32_t k = 0; k < size; ++k)
      chosen[room - size + k] = from[k] == fresh ? T{} : column[first_ + from[k]];
    column.swap(chosen);
  });
  last_ = static_cast<std::uint32_t>(room), first_ = last_ - size;
}

}  // namespace epafi
