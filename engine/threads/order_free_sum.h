/// @file order_free_sum.h  Sums whose bits depend on the terms alone: not on their order, on blocks or on who adds
/// them. For every sum that steers the motion; engine/threads/parallel.h block_sum is for sums that are only reported.
/// Each term is split into three whole numbers of 31 bits on a fixed grid of powers of two, as high as the largest term
/// needs, and whole numbers add up without rounding (pre-rounded sums: Demmel and Nguyen 2015, with integers). Parts on
/// a lower grid are the same whole numbers once their last ones are dropped.
/// Error: 2^-62 of the largest term for each term, then half a unit in the last place of the sum. Below 2^32 terms.
/// Terms that are not finite, above 2^990 or all below 2^-860 are summed by engine/threads/exact_sum.h.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "engine/threads/exact_sum.h"
#include "engine/threads/parallel.h"

namespace epafi {

class OrderFreeSum {
 public:
  /// 0.3 to 0.7 ns a term by the width of the registers, from a hundred terms on.
  void add(std::span<const double> terms);
  void add(double term) { add(std::span(&term, 1)); }
  OrderFreeSum& operator+=(const OrderFreeSum& other);
  /// The sum of terms in range. Otherwise NaN, or where all terms are too small, a sum with an error up to 2^-962 per
  /// term.
  double value() const;
  bool in_range() const { return !is_odd_ && top_ != least_top; }
  /// The largest finite magnitude.
  double largest() const { return largest_; }

  static constexpr int bits = 31;                       ///< between two lines of the grid
  static constexpr int least_top = -28, most_top = 32;  ///< terms are below 2^(bits top - 1)

 private:
  static constexpr int no_top = std::numeric_limits<int>::min();
  void raise(int top);

  std::array<std::int64_t, 3> word_{};  ///< multiples of 2^(bits (top - 1)), (top - 2), (top - 3)
  double largest_ = 0.0;
  int top_ = no_top;  ///< no term but 0 so far
  bool is_odd_ = false;
};

/// Sum of n terms and the largest of their magnitudes.
struct SumAndLargest {
  double sum = 0.0, largest = 0.0;
};

template <class Term>
[[gnu::noinline, gnu::cold]] double exact_value(std::size_t n, const Term& term) {
  ExactSum exact;
  for (std::size_t i = 0; i < n; ++i) exact.add(term(i));
  return exact.value();
}

/// total: of term(i) over [0, n).
template <class Term>
double value_of(const OrderFreeSum& total, std::size_t n, const Term& term) {
  return total.in_range() ? total.value() : exact_value(n, term);
}

/// Totals of `count` terms f(i) each, std::array<double, count>, over [0, n).
template <std::size_t count, class F>
std::array<OrderFreeSum, count> order_free_totals(std::size_t n, const F& f) {
  using Sums = std::array<OrderFreeSum, count>;
  const auto sums_of = [&](std::size_t begin, std::size_t end, Sums & sums)
      __attribute__((noinline)) {  // compiled once
    double terms[count][sum_block];
    for (std::size_t i = begin; i < end; ++i) {
      const std::array<double, count> all = f(i);
      for (std::size_t c = 0; c < count; ++c) terms[c][i - begin] = all[c];
    }
    for (std::size_t c = 0; c < count; ++c) sums[c].add({terms[c], end - begin});
  };
  Sums total;
  if (n <= sum_block) {
    sums_of(0, n, total);
  } else {
    std::vector<Sums>& part = block_results<Sums>((n + sum_block - 1) / sum_block, Sums{});
    parallel_blocks(n, sum_block, [&](std::size_t b, std::size_t e, std::size_t block) { sums_of(b, e, part[block]); });
    for (const Sums& sums : part)
      for (std::size_t c = 0; c < count; ++c) total[c] += sums[c];
  }
  return total;
}

/// Sums of the same.
template <std::size_t count, class F>
std::array<SumAndLargest, count> order_free_sums(std::size_t n, const F& f) {
  const std::array<OrderFreeSum, count> total = order_free_totals<count>(n, f);
  std::array<SumAndLargest, count> out;
  for (std::size_t c = 0; c < count; ++c)
    out[c] = {value_of(total[c], n, [&](std::size_t i) { return f(i)[c]; }), total[c].largest()};
  return out;
}

/// Sum of f(i) over [0, n).
template <class F>
double order_free_sum(std::size_t n, const F& f) {
  return order_free_sums<1>(n, [&](std::size_t i) { return std::array{static_cast<double>(f(i))}; })[0].sum;
}
inline double order_free_sum(std::span<const double> terms) {
  return order_free_sum(terms.size(), [&](std::size_t i) { return terms[i]; });
}

}  // namespace epafi
