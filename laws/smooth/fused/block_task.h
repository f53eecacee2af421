/// @file block_task.h  All runs of a block through the loop over contacts, and what they come to.
#pragma once
#include "engine/lanes/targets.h"
#include "laws/smooth/fused/sphere_kernel.h"

namespace epafi {

struct FindCall {
  SphereBlocks::Block& block;
  const SphereArrays& arrays;
};

/// Everything a block needs, so that the loop is compiled once per target.
template <bool turns>
struct BlockTask {
  explicit BlockTask(const FindCall& call) : block(call.block), arrays(call.arrays) {}
  SphereBlocks::Block& block;
  const SphereArrays& arrays;

  template <int n>
  EPAFI_LANES void run() const {
    SphereTotals<n> total;
    SphereSprings::Places places;
    const bool keeps = arrays.passes->needs.remembers();
    if (keeps && !(arrays.dt > 0.0)) {
      thread_local std::vector<std::uint32_t> from;
      begin_contacts(block, arrays, from);
      block.springs.choose(from);
    }
    if (keeps) places = block.springs.begin_step();
    for (const SphereBlocks::Run& run : block.runs) sweep<n>(run, total, places);
    if (keeps && arrays.dt > 0.0) block.springs.end_step(places);
    block.deepest = block.deepest_relative = 0.0;
    for (int l = 0; l < n; ++l) {
      block.deepest = std::max(block.deepest, double{total.deepest[l]});
      block.deepest_relative = std::max(block.deepest_relative, double{total.deepest_relative[l]});
    }
    block.touching = total.touching;
    block.viscous = total.viscous.total();
    block.late = total.late.total();
    block.lost = total.lost.total();
    if (arrays.tells_energy) block.elastic = total.elastic.total() + 0.5 * total.twice_stored.total();
    block.slipped = 0.5 * total.twice_slipped.total() + total.released;
    if (!block.images.empty()) block.virial = total.virial.sums();
  }

 private:
  template <int n>
  EPAFI_LANES void sweep(const SphereBlocks::Run& run, SphereTotals<n>& total, SphereSprings::Places& places) const {
    if (run.plane >= 0)  // a plane has no image
      sweep<n, true, false>(run, total, places);
    else if (!block.images.empty())
      sweep<n, false, true>(run, total, places);
    else
      sweep<n, false, false>(run, total, places);
  }
  /// Each kind of run is a function of its own.
  template <int n, bool wall, bool periodic>
  EPAFI_LANES void sweep(const SphereBlocks::Run& run, SphereTotals<n>& total, SphereSprings::Places& places) const {
    run_apart<n>(SphereSweep<n, turns, wall, periodic>{block, run, arrays, total, places});
  }
};

template <bool turns>
auto find_loop() {
  return best_loop<BlockTask<turns>, FindCall>();
}

/// Of several processes: owners by place, and the blocks whose contacts all count here.
inline void find_owners(const World& world, const SphereBlocks& blocks, std::vector<std::uint8_t>& owner,
                        std::vector<std::uint8_t>& counts_all) {
  if (world.owner.empty()) return;
  blocks.balls().by_place(world.owner, owner);
  counts_all.assign(blocks.blocks().size(), 1);
  for (std::size_t i = 0; i < counts_all.size(); ++i)
    for (std::size_t k = blocks.begin_of(i); k < blocks.end_of(i); ++k)
      if (owner[k] != World::here) counts_all[i] = 0;
}

}  // namespace epafi
