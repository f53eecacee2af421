/// @file sweep_and_prune.h  Intervals sorted along the axis of largest spread, swept once (Baraff 1992; Cohen et al.
/// 1995), in rows across the axis of second largest spread: in a cube of N bodies an interval meets some N^(2/3)
/// others, in rows as wide as the largest body some N^(1/3). The order of the last list is nearly that of the next:
/// insertion sort takes a few exchanges per body. Best for few bodies and for long thin scenes.
#pragma once
#include "detection/broad/broad_phase.h"

namespace epafi {

class SweepAndPrune final : public ListBroadPhase {
 public:
  using ListBroadPhase::ListBroadPhase;
  const char* name() const override { return "sweep-and-prune"; }

 private:
  struct Interval {
    double min, max;
    Slot slot;
  };
  std::vector<Interval> interval_;        ///< sorted by min
  std::vector<Interval> swept_;           ///< row by row, in each sorted by min
  std::vector<std::uint32_t> row_begin_;  ///< of swept_, by row
  std::vector<std::uint32_t> row_;        ///< of interval_[k]
  std::vector<Ball> ball_;                ///< in the order of swept_
  std::vector<std::vector<Slot>> found_;
  double longest_ = 0.0;  ///< interval [m]
  int axis_ = -1, across_ = -1;

  void collect(const FatBodies& bodies, PairCollector& collector) override;
  void choose_axes(const FatBodies& bodies);
  void sort_intervals(const FatBodies& bodies);
  void make_rows(const FatBodies& bodies);
  void sweep(std::size_t begin, std::size_t end, std::size_t block, PairCollector& collector);
};

}  // namespace epafi
