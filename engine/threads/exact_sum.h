/// @file exact_sum.h  A sum of doubles that is rounded once, when it is read (Neal 2015, small superaccumulator):
/// its value depends on the terms alone, not on their order. 560 bytes, about 7 ns a term; many terms of one size are
/// summed in a tenth of that by engine/threads/order_free_sum.h. Limit: 2^62 terms.
#pragma once
#include <array>
#include <cstdint>

namespace epafi {

class ExactSum {
 public:
  void add(double x);
  ExactSum& operator+=(const ExactSum& other);
  /// The nearest double, ties to even. NaN where a term is one or infinities of both signs are among them.
  double value() const;

 private:
  static constexpr std::size_t limbs = 68;  // of 32 bits each: 2^-1074 to the largest double times 2^62
  static constexpr std::uint32_t most_pending = 0x3fffffff;

  void carry();
  double finite_value() const;
  bool is_negative() const { return limb_[limbs - 1] < 0; }

  std::array<std::int64_t, limbs> limb_{};  ///< multiples of 2^(32 k - 1074), each with a sign of its own
  std::uint32_t pending_ = 0;               ///< terms since the last carry; fewer than 2^30 leave every limb in range
  bool plus_infinity_ = false, minus_infinity_ = false, not_a_number_ = false;
};

}  // namespace epafi
