/// @file pair_collector.h  Gathers the near pairs that a method finds, in any order and from any thread, into the canonical list.
/// A method hands over each ordinary body once with its candidates. Pairs whose A it is form a run of their own; the others
/// are counted into place by A. The list depends on the set of pairs alone, so it is the same bits for every thread count.
#pragma once
#include "detection/broad/fat_bodies.h"
#include "engine/contacts.h"

namespace epafi {

class PairCollector {
 public:
  PairCollector(const FatBodies& bodies, const PairFilter& filter) : bodies_(bodies), filter_(filter) {}

  void begin(std::size_t blocks);
  /// Candidates of ordinary body i: of every near pair of ordinary bodies one side is handed in as the other's candidate, once.
  /// Candidates that are not near are dropped. Each i belongs to one call and one block; blocks may run in parallel.
  void add(std::size_t block, Slot i, std::span<const Slot> candidates);
  /// Writes the sorted list.
  void finish(PairColumn& pairs);

 private:
  struct Block {
    std::vector<Slot> own;  ///< partners b of runs with one A
    std::vector<Pair> rest;
  };
  struct Run {
    std::uint32_t block = 0, begin = 0, size = 0;
  };
  const FatBodies& bodies_;
  const PairFilter& filter_;
  std::vector<Block> blocks_;
  std::vector<Run> run_;                           ///< by slot of A
  std::vector<std::uint32_t> rest_begin_, begin_;  ///< by slot of A
  std::vector<Slot> rest_;                         ///< partners, grouped by A

  void add_apart(Block& block, Slot i);
  void place(Block& block, Slot i, Slot j);
  void group_rest();
};

}  // namespace epafi
