/// @file block_product.h  The inner loop of block factorisations: columns of N x N blocks that are subtracted from
/// others. Compiled for SSE2 and AVX2 and chosen at start; without fused multiply-add both give the same bits.
#pragma once
#include <cstddef>
#include <cstdint>

namespace epafi {

/// For k in [first, last): work[row[k]] -= a[k] b^T, all blocks stored by columns.
void subtract_products_6(double* work, const std::uint32_t* row, const double* a, const double* b, std::size_t first,
                         std::size_t last);
void subtract_products_3(double* work, const std::uint32_t* row, const double* a, const double* b, std::size_t first,
                         std::size_t last);

template <int N>
void subtract_products(double* work, const std::uint32_t* row, const double* a, const double* b, std::size_t first,
                       std::size_t last) {
  if constexpr (N == 6)
    subtract_products_6(work, row, a, b, first, last);
  else
    subtract_products_3(work, row, a, b, first, last);
}

}  // namespace epafi
