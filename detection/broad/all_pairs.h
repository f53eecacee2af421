/// @file all_pairs.h  Every pair is tested: n^2/2 tests, no structure. The reference for the other methods, and the
/// fastest below some fifty bodies.
#pragma once
#include "detection/broad/broad_phase.h"
#include "engine/threads/parallel.h"

namespace epafi {

class AllPairs final : public ListBroadPhase {
 public:
  using ListBroadPhase::ListBroadPhase;
  const char* name() const override { return "all-pairs"; }

 private:
  static constexpr std::size_t block_size = 64;
  void collect(const FatBodies& bodies, PairCollector& collector) override {
    const auto& all = bodies.ordinary;
    collector.begin((all.size() + block_size - 1) / block_size);
    parallel_blocks(all.size(), block_size, [&](std::size_t begin, std::size_t end, std::size_t block) {
      for (std::size_t i = begin; i < end; ++i) collector.add(block, all[i], std::span(all).subspan(i + 1));
    });
  }
};

}  // namespace epafi
