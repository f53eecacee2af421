#include "laws/nonsmooth/coloring.h"

#include <algorithm>
#include <array>
#include <bit>

#include "engine/parallel_order.h"

namespace epafi {

void Coloring::update(std::span<const Slot> a, std::span<const Slot> b, std::span<const double> inverse_mass) {
  const auto begins = [&](std::size_t i) { return i == 0 || a[i] != a[i - 1] || b[i] != b[i - 1]; };
  const auto group = [&](std::size_t i) { return ContactGroup{a[i], b[i], static_cast<std::uint32_t>(i), 1}; };
  parallel_select(a.size(), begins, group, found_);
  parallel_for(found_.size(), [&](std::size_t g) {
    const std::size_t end = g + 1 < found_.size() ? found_[g + 1].first : a.size();
    found_[g].count = static_cast<std::uint32_t>(end) - found_[g].first;
  });
  free_found_.resize(inverse_mass.size());
  parallel_for(free_found_.size(), [&](std::size_t s) { free_found_[s] = inverse_mass[s] > 0.0; });
  const auto differs = [&](std::size_t g) { return found_[g].a != canonical_[g].a || found_[g].b != canonical_[g].b; };
  const bool same =
      free_found_ == free_ && found_.size() == canonical_.size() &&
      block_max<char>(found_.size(), 0, [&](std::size_t g) { return static_cast<char>(differs(g)); }) == 0;
  canonical_.swap(found_), free_.swap(free_found_);
  if (!same) paint();
  const auto each = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t g = begin; g < end; ++g) f(color_[g], canonical_[g]);
  };
  parallel_group(
      canonical_.size(), colors(), order_, each, [&](std::size_t count) { groups_.resize(count); },
      [&](std::uint32_t place, const ContactGroup& g) { groups_[place] = g; });
}

void Coloring::paint() {
  used_.assign(free_.size(), 0);
  color_.resize(canonical_.size());
  std::array<std::size_t, max_colors + 1> count{};
  for (std::size_t g = 0; g < canonical_.size(); ++g) {
    const ContactGroup& group = canonical_[g];
    const bool free_a = free_[group.a] != 0, free_b = free_[group.b] != 0;
    const std::uint64_t taken = (free_a ? used_[group.a] : 0) | (free_b ? used_[group.b] : 0);
    const auto color = static_cast<std::size_t>(std::countr_one(taken));
    color_[g] = static_cast<std::uint8_t>(std::min(color, max_colors));
    ++count[color_[g]];
    if (color >= max_colors) continue;  // the bit of the overflow colour is never set
    if (free_a) used_[group.a] |= std::uint64_t{1} << color;
    if (free_b) used_[group.b] |= std::uint64_t{1} << color;
  }
  has_overflow_ = count[max_colors] > 0;
  const auto last = std::find_if(count.rbegin(), count.rend(), [](std::size_t n) { return n > 0; });
  const auto colors = static_cast<std::size_t>(count.rend() - last);
  begin_.assign(1, 0);
  for (std::size_t c = 0; c < colors; ++c) begin_.push_back(begin_.back() + count[c]);
}

}  // namespace epafi
