/// @file partition.h  Which rank owns which part of space: recursive coordinate bisection by Zoltan. No result
/// depends on where the cuts are.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "engine/state/types.h"

namespace epafi {

class Partition {
 public:
  Partition();
  ~Partition();
  Partition(const Partition&) = delete;
  Partition& operator=(const Partition&) = delete;

  /// Computes cuts with equal weights of all ranks; points: those of this rank, with weight 1 by default. Called by all
  /// ranks.
  void cut(std::span<const Vec3> points, std::span<const float> weights = {});
  int owner(const Vec3& x) const;
  /// True if a cube of this half side is certainly inside the part of this rank.
  bool is_deep(const Vec3& x, double half, int rank) const;
  /// Adds the ranks whose part meets a cube of this half side.
  void ranks_near(const Vec3& x, double half, std::vector<int>& ranks) const;

 private:
  struct Cuts;
  std::unique_ptr<Cuts> cuts_;
};

}  // namespace epafi
