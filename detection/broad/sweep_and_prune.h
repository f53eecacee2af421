/// @file sweep_and_prune.h  Intervals sorted along the axis of largest spread, swept once (Baraff 1992; Cohen et al. 1995).
/// The order of the last list is nearly that of the next: insertion sort takes a few exchanges per body. Best for few bodies
/// and for long thin scenes; in a cube of N bodies each interval meets some N^(2/3) others.
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
  std::vector<Interval> interval_;  ///< sorted by min
  std::vector<Ball> ball_;          ///< in the order of the intervals
  std::vector<std::vector<Slot>> found_;
  int axis_ = -1;

  void collect(const FatBodies& bodies, PairCollector& collector) override;
  void sort_intervals(const FatBodies& bodies);
};

}  // namespace epafi
