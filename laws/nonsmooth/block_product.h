/// @file block_product.h  The inner loop of block factorisations: products of panels of N x N blocks that are
/// subtracted from others. Compiled for SSE2 and AVX2 and chosen at start; without fused multiply-add both give the
/// same bits.
#pragma once
#include <cstddef>
#include <cstdint>

namespace epafi {

/// For k in [first, last): block place[k] of `work` -= a_k b^T with rows of `depth` blocks of N x N, each stored by
/// columns: a_k starts at block k * stride of `a`, b at its own beginning. One number beyond the last block is read.
struct PanelProduct {
  double* work;
  const std::uint32_t* place;
  const double *a, *b;
  std::size_t first, last, stride, depth;
};
void subtract_panels_6(const PanelProduct& product);
void subtract_panels_3(const PanelProduct& product);

template <int N>
void subtract_panels(const PanelProduct& product) {
  if constexpr (N == 6)
    subtract_panels_6(product);
  else
    subtract_panels_3(product);
}

}  // namespace epafi
