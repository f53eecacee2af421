#include "laws/nonsmooth/coloring.h"

#include <algorithm>
#include <array>
#include <bit>

#include "engine/state/hash.h"
#include "engine/threads/parallel_order.h"

namespace epafi {

namespace {
/// Hash of two ids, the lower one first. Unique, since mix_bits is a bijection.
std::uint64_t hash_of(BodyId a, BodyId b) {
  const auto low = static_cast<std::uint64_t>(std::min(a, b)), high = static_cast<std::uint64_t>(std::max(a, b));
  return mix_bits(low << 32 | high);
}
}  // namespace

void Coloring::update(std::span<const Slot> a, std::span<const Slot> b, const Bodies& bodies) {
  find_groups(a, b);
  const auto differs = [&](std::size_t g) { return found_[g].a != canonical_[g].a || found_[g].b != canonical_[g].b; };
  const bool same =
      find_bodies(bodies) && found_.size() == canonical_.size() &&
      block_max<char>(found_.size(), 0, [&](std::size_t g) { return static_cast<char>(differs(g)); }) == 0;
  canonical_.swap(found_);
  if (!same) paint();
  const auto each = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t g = begin; g < end; ++g) f(color_[g], canonical_[g]);
  };
  parallel_group(
      canonical_.size(), colors(), order_, each, [&](std::size_t count) { groups_.resize(count); },
      [&](std::uint32_t place, const ContactGroup& g) { groups_[place] = g; });
}

void Coloring::find_groups(std::span<const Slot> a, std::span<const Slot> b) {
  const auto begins = [&](std::size_t i) { return i == 0 || a[i] != a[i - 1] || b[i] != b[i - 1]; };
  const auto group = [&](std::size_t i) { return ContactGroup{a[i], b[i], static_cast<std::uint32_t>(i), 1}; };
  parallel_select(a.size(), begins, group, found_);
  parallel_for(found_.size(), [&](std::size_t g) {
    const std::size_t end = g + 1 < found_.size() ? found_[g + 1].first : a.size();
    found_[g].count = static_cast<std::uint32_t>(end) - found_[g].first;
  });
}

/// True if they are those of the last call.
bool Coloring::find_bodies(const Bodies& bodies) {
  const std::size_t n = bodies.inverse_mass.size();
  free_found_.resize(n);
  id_found_.resize(n);
  parallel_for(n, [&](std::size_t s) {
    free_found_[s] = bodies.inverse_mass[s] > 0.0;
    id_found_[s] = bodies.id.empty() ? static_cast<BodyId>(s) : bodies.id[s];
  });
  const bool same = free_found_ == free_ && id_found_ == id_;
  free_.swap(free_found_);
  id_.swap(id_found_);
  return same;
}

/// By buckets of four, each sorted.
void Coloring::sort_by_hash() {
  const int bits = std::max(1, static_cast<int>(std::bit_width(canonical_.size())) - 2);
  const std::size_t buckets = std::size_t{1} << bits;
  const auto each = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t g = begin; g < end; ++g) {
      const ContactGroup& pair = canonical_[g];
      const std::uint64_t hash = hash_of(id_[pair.a], id_[pair.b]);
      f(hash >> (64 - bits), Hashed{hash, pair.a, pair.b, static_cast<std::uint32_t>(g)});
    }
  };
  parallel_group(
      canonical_.size(), buckets, place_, each, [&](std::size_t count) { hashed_.resize(count); },
      [&](std::uint32_t place, const Hashed& pair) { hashed_[place] = pair; });
  parallel_for(buckets, [&](std::size_t k) {
    std::sort(hashed_.data() + place_[k], hashed_.data() + place_[k + 1],
              [](const Hashed& x, const Hashed& y) { return x.hash < y.hash; });
  });
}

/// The first one that no earlier pair at its free bodies has.
std::size_t Coloring::color_of(const Hashed& pair) {
  AtBody none{};
  AtBody &a = free_[pair.a] != 0 ? at_[pair.a] : none, &b = free_[pair.b] != 0 ? at_[pair.b] : none;
  const auto color = static_cast<std::size_t>(std::countr_one(a.used | b.used));
  a.rounds = b.rounds = std::max(a.rounds, b.rounds) + 1;
  rounds_ = std::max<std::size_t>(rounds_, a.rounds);
  if (color >= max_colors) return max_colors;  // the bit of the overflow colour is never set
  a.used |= std::uint64_t{1} << color;
  b.used |= std::uint64_t{1} << color;
  return color;
}

void Coloring::paint() {
  sort_by_hash();
  at_.assign(free_.size(), {});
  color_.resize(canonical_.size());
  rounds_ = 0;
  std::array<std::size_t, max_colors + 1> count{};
  for (const Hashed& pair : hashed_) {
    const std::size_t color = color_of(pair);
    color_[pair.group] = static_cast<std::uint8_t>(color);
    ++count[color];
  }
  has_overflow_ = count[max_colors] > 0;
  const auto last = std::find_if(count.rbegin(), count.rend(), [](std::size_t n) { return n > 0; });
  const auto colors = static_cast<std::size_t>(count.rend() - last);
  begin_.assign(1, 0);
  for (std::size_t c = 0; c < colors; ++c) begin_.push_back(begin_.back() + count[c]);
}

}  // namespace epafi
