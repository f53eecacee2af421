/// @file ordered_sum.h  Sums over many bodies with the bits of a plain loop.
#pragma once
#include <algorithm>

#include "engine/parallel.h"

namespace epafi {

/// f(0) + f(1) + ... + f(n - 1), added in this order. Several threads make the terms, a piece at a time; one adds them:
/// of the mean place of 100 000 bodies 1.5 of 1.7 ms is finding and weighing them.
template <class T, class F>
T ordered_sum(std::size_t n, T sum, const F& f) {
  constexpr std::size_t piece = 16384;  // terms that stay in a processor's own memory
  std::vector<T>& term = block_results<T>(std::min(n, piece), sum);
  for (std::size_t first = 0; first < n; first += piece) {
    const std::size_t count = std::min(piece, n - first);
    parallel_for(count, [&](std::size_t k) { term[k] = f(first + k); });
    for (std::size_t k = 0; k < count; ++k) sum += term[k];
  }
  return sum;
}

}  // namespace epafi
