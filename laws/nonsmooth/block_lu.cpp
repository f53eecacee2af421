#include "laws/nonsmooth/block_lu.h"

#include <Eigen/LU>

#include "laws/nonsmooth/block_product.h"

namespace epafi {

template <int N>
void BlockLu<N>::analyse(std::size_t n, const std::vector<BlockPattern::Edge>& edges) {
  pattern_.analyse(n, edges);
  diagonal.resize(n), lower.resize(edges.size()), upper.resize(edges.size());
  l_.resize(pattern_.row.size()), u_.resize(pattern_.row.size()), pivot_.resize(n), y_.resize(n);
  work_l_.resize(n), work_u_.resize(n);
}

/// Column j of A below the diagonal and row j right of it, into the work columns.
template <int N>
void BlockLu<N>::gather(std::uint32_t j) {
  work_l_[j] = diagonal[pattern_.at[j]];
  for (std::size_t p = pattern_.begin[j]; p < pattern_.begin[j + 1]; ++p)
    work_l_[pattern_.row[p]].setZero(), work_u_[pattern_.row[p]].setZero();
  for (std::size_t k = pattern_.edges_begin[j]; k < pattern_.edges_begin[j + 1]; ++k) {
    const std::uint32_t e = pattern_.edge_of[k];
    const std::uint32_t a = pattern_.place[pattern_.edges[e].first], b = pattern_.place[pattern_.edges[e].second];
    if (a > b)
      work_l_[a] = lower[e], work_u_[a] = upper[e].transpose();
    else
      work_l_[b] = upper[e], work_u_[b] = lower[e].transpose();
  }
}

template <int N>
bool BlockLu<N>::factor() {
  for (std::uint32_t j = 0; j < pattern_.size(); ++j) {
    gather(j);
    for (std::size_t k = pattern_.entries_begin[j]; k < pattern_.entries_begin[j + 1]; ++k) {
      const BlockPattern::Entry& entry = pattern_.entries[k];
      const double *l_jk = l_[entry.position].data(), *u_kj = u_[entry.position].data();
      const std::size_t end = pattern_.begin[entry.column + 1];
      subtract_products<N>(work_l_[0].data(), pattern_.row.data(), l_[0].data(), u_kj, entry.position, end);
      subtract_products<N>(work_u_[0].data(), pattern_.row.data(), u_[0].data(), l_jk, entry.position + 1, end);
    }
    pivot_[j] = Eigen::PartialPivLU<Block>(work_l_[j]).inverse();
    if (!pivot_[j].allFinite()) return false;
    for (std::size_t p = pattern_.begin[j]; p < pattern_.begin[j + 1]; ++p) {
      l_[p].noalias() = work_l_[pattern_.row[p]] * pivot_[j];
      u_[p] = work_u_[pattern_.row[p]];
    }
  }
  return true;
}

template <int N>
void BlockLu<N>::solve(std::vector<Vector>& x) {
  const std::size_t n = pattern_.size();
  for (std::size_t j = 0; j < n; ++j) y_[j] = x[pattern_.at[j]];
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t p = pattern_.begin[j]; p < pattern_.begin[j + 1]; ++p)
      y_[pattern_.row[p]].noalias() -= l_[p] * y_[j];
  for (std::size_t j = n; j-- > 0;) {
    for (std::size_t p = pattern_.begin[j]; p < pattern_.begin[j + 1]; ++p)
      y_[j].noalias() -= u_[p].transpose() * y_[pattern_.row[p]];
    y_[j] = (pivot_[j] * y_[j]).eval();
  }
  for (std::size_t j = 0; j < n; ++j) x[pattern_.at[j]] = y_[j];
}

template class BlockLu<6>;
template class BlockLu<3>;

}  // namespace epafi
