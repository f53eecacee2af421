#include "laws/nonsmooth/block_product.h"

namespace epafi {

namespace {

/// c -= a b^T: running sums stay in registers.
template <int N>
[[gnu::always_inline]] inline void subtract(double* __restrict c, const double* __restrict a,
                                            const double* __restrict b) {
  for (int j = 0; j < N; ++j) {
    double s[N];
    for (int i = 0; i < N; ++i) s[i] = c[N * j + i];
    for (int k = 0; k < N; ++k) {
      const double f = b[N * k + j];
      for (int i = 0; i < N; ++i) s[i] -= a[N * k + i] * f;
    }
    for (int i = 0; i < N; ++i) c[N * j + i] = s[i];
  }
}

using Four = double __attribute__((vector_size(32), aligned(8), may_alias));
using Two = double __attribute__((vector_size(16), aligned(8), may_alias));

/// The same for N = 6, a column as four and two lanes: twelve sums in registers.
template <>
[[gnu::always_inline]] inline void subtract<6>(double* __restrict c, const double* __restrict a,
                                               const double* __restrict b) {
  Four high[6];
  Two low[6];
  for (int j = 0; j < 6; ++j) {
    high[j] = *reinterpret_cast<const Four*>(c + 6 * j);
    low[j] = *reinterpret_cast<const Two*>(c + 6 * j + 4);
  }
  for (int k = 0; k < 6; ++k) {
    const Four a4 = *reinterpret_cast<const Four*>(a + 6 * k);
    const Two a2 = *reinterpret_cast<const Two*>(a + 6 * k + 4);
#pragma GCC unroll 6
    for (int j = 0; j < 6; ++j) high[j] -= a4 * b[6 * k + j], low[j] -= a2 * b[6 * k + j];
  }
  for (int j = 0; j < 6; ++j) {
    *reinterpret_cast<Four*>(c + 6 * j) = high[j];
    *reinterpret_cast<Two*>(c + 6 * j + 4) = low[j];
  }
}

}  // namespace

[[gnu::target_clones("avx2", "default")]] void subtract_products_6(double* work, const std::uint32_t* row,
                                                                   const double* a, const double* b, std::size_t first,
                                                                   std::size_t last) {
  for (std::size_t k = first; k < last; ++k) subtract<6>(work + 36 * static_cast<std::size_t>(row[k]), a + 36 * k, b);
}

[[gnu::target_clones("avx2", "default")]] void subtract_products_3(double* work, const std::uint32_t* row,
                                                                   const double* a, const double* b, std::size_t first,
                                                                   std::size_t last) {
  for (std::size_t k = first; k < last; ++k) subtract<3>(work + 9 * static_cast<std::size_t>(row[k]), a + 9 * k, b);
}

}  // namespace epafi
