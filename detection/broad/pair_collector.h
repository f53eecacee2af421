/// @file pair_collector.h  Collects the near pairs of a method, in any order and from any thread, in the canonical
/// list. A method passes each ordinary body once with its candidates. Pairs with this body as A form a run; the others
/// are sorted by A (counting sort). The list depends only on the set of pairs, so its bits are the same for every
/// thread count.
#pragma once
#include "detection/broad/fat_bodies.h"
#include "engine/state/contacts.h"

namespace epafi {

/// Puts entries (row, partner), sorted, among those of their rows, which are sorted too; rows up to `rows` begin or
/// end where they have none.
void insert_pairs(const std::vector<std::pair<Slot, Slot>>& entries, std::size_t rows, SpherePairs& list);

/// Half-spaces side by side: a list tests each of them against every body.
struct alignas(64) EightPlanes {
  double normal[3][8]{}, point[3][8]{};
  double reach[8];     ///< of a place without a plane -infinity: no body is near
  unsigned loose = 0;  ///< a bit each
};

class PairCollector {
 public:
  PairCollector(const FatBodies& bodies, const PairFilter& filter) : bodies_(bodies), filter_(filter) {}

  /// in_order: with bodies.ordered_spheres, of a method that hands in the bodies by ascending slots, in ascending
  /// blocks, each with all that it is near: nothing is left to be sorted then.
  void begin(std::size_t blocks, bool in_order = false);
  /// Candidates of ordinary body i: of every near pair of ordinary bodies one side is handed in as the other's
  /// candidate, once. Candidates that are not near are dropped. Each i belongs to one call and one block; blocks may
  /// run in parallel. met: the balls of all candidates are known to overlap that of i.
  void add(std::size_t block, Slot i, std::span<const Slot> candidates, bool met = false);
  /// Writes the sorted list, and that of the spheres where the setup wants it.
  void finish(PairColumn& pairs);
  void finish(SpherePairs& pairs);
  /// Adds to finished lists the pairs of the bodies from slot `old` on with all others; those of balls, of
  /// which there are so many, are left to BallPairs.
  void add_behind(std::size_t old, std::size_t balls, PairList& pairs) const;

 private:
  struct Block {
    std::vector<Slot> own;  ///< partners b of runs with one A
    std::vector<Pair> rest;
    std::vector<Slot> spheres;  ///< a sphere, the number of its partners, these; and so on; in order: partners alone
    Slot begin = no_slot;       ///< in order: the first of its spheres
    std::vector<std::uint8_t> near_planes{};  ///< of one body, a bit for each of eight planes
  };
  struct Run {
    std::uint32_t block = 0, begin = 0, size = 0;
  };
  const FatBodies& bodies_;
  const PairFilter& filter_;
  std::vector<Block> blocks_;
  bool in_order_ = false;
  std::vector<EightPlanes> planes_;
  std::vector<std::uint32_t> plane_at_;            ///< their places in bodies_.apart
  std::vector<Slot> other_;                        ///< bodies there that are none
  std::vector<Run> run_;                           ///< by slot of A
  std::vector<std::uint32_t> rest_begin_, begin_;  ///< by slot of A
  std::vector<Slot> rest_;                         ///< partners, grouped by A
  UnwrittenColumn<std::uint32_t> first_;           ///< in order, by slot: [s + 1] is the number of its partners

  void sort_apart();
  void add_planes(Block& block, Slot i) const;
  void add_plane(Block& block, Slot i, std::size_t k) const;
  void add_apart(Block& block, Slot i) const;
  void add_higher(Block& block, Slot i, std::span<const Slot> candidates) const;
  void join_in_order(SpherePairs& pairs);
  void place(Block& block, Slot i, Slot j) const;
  void group_rest();
};

}  // namespace epafi
