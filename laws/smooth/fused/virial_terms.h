/// @file virial_terms.h  The virial of a block: a periodic cell that keeps a pressure follows it, so its bits must not
/// depend on which contacts lie in which block or tile. Terms are kept until there is no room, then added without
/// order.
#pragma once
#include <array>

#include "engine/threads/order_free_sum.h"

namespace epafi {

class VirialTerms {
 public:
  static constexpr std::size_t room = 512, most_at_once = 64;  ///< terms of an axis: 12 kB, in the nearest cache

  /// Where the next terms of an axis go, at most `most_at_once`; those behind the last one that counts are written
  /// over.
  double* next(std::size_t axis) { return kept_[axis] + count_; }
  /// Accepts the number of terms written.
  void advance(std::size_t terms) {
    count_ += terms;
    if (count_ + most_at_once > room) flush();
  }
  std::array<OrderFreeSum, 3> sums() {
    flush();
    return sum_;
  }

 private:
  [[gnu::noinline]] void flush() {
    for (std::size_t k = 0; k < 3; ++k) sum_[k].add({kept_[k], count_});
    count_ = 0;
  }

  alignas(64) double kept_[3][room];
  std::size_t count_ = 0;
  std::array<OrderFreeSum, 3> sum_;
};

}  // namespace epafi
