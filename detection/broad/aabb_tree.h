/// @file aabb_tree.h  Binary tree of boxes, refitted while it stays good and rebuilt when it does not (van den Bergen
/// 1997). Built from the top: a node of mixed sizes is split by size, any other at the median of its longest axis.
/// Boulders thus stand in a subtree of their own and do not swell the nodes of the dust. Quality is the sum of node
/// surfaces, to which the cost of a query is proportional (Goldsmith and Salmon 1987). Better than a grid where sizes
/// and density both vary widely.
#pragma once
#include "detection/broad/broad_phase.h"

namespace epafi {

class AabbTree final : public ListBroadPhase {
 public:
  using ListBroadPhase::ListBroadPhase;
  const char* name() const override { return "aabb-tree"; }
  std::size_t builds() const { return builds_; }  ///< from the top; all other updates were refits

 private:
  /// Nodes stand in depth-first order: the left child follows its parent.
  struct Node {
    Aabb box;
    std::uint32_t right = 0;             ///< 0 in leaves
    std::uint32_t first = 0, count = 0;  ///< bodies of the subtree in the sorted columns
  };
  std::vector<Node> node_;
  std::vector<std::uint32_t> leaf_;  ///< nodes without children
  std::vector<Slot> slot_;           ///< in tree order, as are the next two
  std::vector<Aabb> box_;
  std::vector<Ball> ball_;
  double surface_when_built_ = 0.0;
  std::size_t builds_ = 0;

  struct Scratch {
    std::vector<std::uint32_t> stack, leaves;
    std::vector<Slot> found;
  };
  std::vector<Scratch> scratch_;  ///< one per block

  void collect(const FatBodies& bodies, PairCollector& collector) override;
  void build(const FatBodies& bodies);
  void split(const FatBodies& bodies, std::uint32_t first, std::uint32_t count);
  std::uint32_t partition(const FatBodies& bodies, std::uint32_t first, std::uint32_t count);
  void refit(const FatBodies& bodies);
  double surface() const;
  void find_leaves(const Aabb& box, Scratch& scratch) const;
};

}  // namespace epafi
