// The sums of forces by body: one accumulator for each block that is at work.
#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

#include "laws/smooth/fused/sphere_blocks.h"

namespace epafi {

void SphereBlocks::set_accumulators(std::size_t accumulators) {
  if (is_clear_.size() == accumulators) return;
  release(sums_);
  release(moments_);
  sums_.resize(accumulators * (block_size_ + 1));
  moments_.resize(needs_.rolling ? accumulators * block_size_ : 0);
  is_clear_.assign(accumulators, 0);
}

void SphereBlocks::clear_accumulator(std::size_t accumulator) {
  if (std::exchange(is_clear_[accumulator], std::uint8_t{1}) != 0) return;  // as the pass over the bodies leaves it
  std::fill_n(sums(accumulator), block_size_, SphereSum{});
  if (needs_.rolling) std::fill_n(moments(accumulator), block_size_, Lanes{});
}

void SphereBlocks::receive(std::size_t i, std::size_t accumulator) {
  SphereSum* const mine = sums(accumulator);
  const std::size_t begin = begin_of(i);
  const auto& sources = blocks_[i].sources;
  for (auto source = sources.rbegin(); source != sources.rend(); ++source) {
    const Block& from = blocks_[*source];
    const auto target = target_of(from, i);
    for (std::uint32_t k = target == from.targets.begin() ? 0 : std::prev(target)->records_end; k < target->records_end;
         ++k) {
      const std::size_t slot = from.record_places[k].slot() - begin;
      const SphereRecord& found = from.records[k];
      Lanes first;
      std::memcpy(&first, found.first, sizeof first);
      mine[slot].first += first;
      for (int l = 0; l < 2; ++l) mine[slot].second[l] += found.second[l];
      if (needs_.rolling) moments(accumulator)[slot] += from.record_moments[k];
    }
  }
}

}  // namespace epafi
