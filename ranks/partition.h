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

  /// New cuts, so that every rank has as much weight of all points; points: those of this rank, of weight 1 where none
  /// are given. The longest extent is cut; lengths along each axis count as so many times as long. By all ranks.
  void cut(std::span<const Vec3> points, std::span<const float> weights = {}, const Vec3& scale = Vec3::Ones());
  /// 1 along axes on which some rank's part ends, else 0.
  Vec3 cut_axes() const;
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
