#include "laws/nonsmooth/block_cholesky.h"

#include <cmath>

#include "laws/nonsmooth/block_product.h"

namespace epafi {

namespace {

/// Lower Cholesky factor in place; false when a pivot is not positive.
template <int N>
bool cholesky(Eigen::Matrix<double, N, N>& a) {
  for (int j = 0; j < N; ++j) {
    double d = a(j, j);
    for (int k = 0; k < j; ++k) d -= a(j, k) * a(j, k);
    if (!(d > 0.0)) return false;
    const double root = std::sqrt(d), inverse = 1.0 / root;
    a(j, j) = root;
    for (int i = j + 1; i < N; ++i) {
      double s = a(i, j);
      for (int k = 0; k < j; ++k) s -= a(i, k) * a(j, k);
      a(i, j) = s * inverse;
    }
    for (int i = 0; i < j; ++i) a(i, j) = 0.0;
  }
  return true;
}

/// x = x L^-T.
template <int N>
void solve_right(const Eigen::Matrix<double, N, N>& l, Eigen::Matrix<double, N, N>& x) {
  for (int j = 0; j < N; ++j) {
    for (int k = 0; k < j; ++k) x.col(j) -= l(j, k) * x.col(k);
    x.col(j) *= 1.0 / l(j, j);
  }
}

template <int N>
void solve_lower(const Eigen::Matrix<double, N, N>& l, Eigen::Matrix<double, N, 1>& x) {
  for (int j = 0; j < N; ++j) {
    x(j) /= l(j, j);
    for (int i = j + 1; i < N; ++i) x(i) -= l(i, j) * x(j);
  }
}

template <int N>
void solve_upper(const Eigen::Matrix<double, N, N>& l, Eigen::Matrix<double, N, 1>& x) {
  for (int j = N - 1; j >= 0; --j) {
    for (int i = j + 1; i < N; ++i) x(j) -= l(i, j) * x(i);
    x(j) /= l(j, j);
  }
}

}  // namespace

template <int N>
void BlockCholesky<N>::analyse(std::size_t n, const std::vector<BlockPattern::Edge>& edges) {
  pattern_.analyse(n, edges);
  diagonal.resize(n), off_diagonal.resize(edges.size());
  lower_.resize(pattern_.row.size()), pivot_.resize(n), work_.resize(n), y_.resize(n);
}

template <int N>
bool BlockCholesky<N>::factor() {
  const std::size_t n = pattern_.at.size();
  for (std::uint32_t j = 0; j < n; ++j) {
    work_[j] = diagonal[pattern_.at[j]];
    for (std::size_t p = pattern_.begin[j]; p < pattern_.begin[j + 1]; ++p) work_[pattern_.row[p]].setZero();
    for (std::size_t k = pattern_.edges_begin[j]; k < pattern_.edges_begin[j + 1]; ++k) {
      const std::uint32_t e = pattern_.edge_of[k];
      const std::uint32_t a = pattern_.place[pattern_.edges[e].first], b = pattern_.place[pattern_.edges[e].second];
      if (a > b)
        work_[a] = off_diagonal[e];  // rows of the later one
      else
        work_[b] = off_diagonal[e].transpose();
    }
    for (std::size_t k = pattern_.entries_begin[j]; k < pattern_.entries_begin[j + 1]; ++k) {
      const BlockPattern::Entry& entry = pattern_.entries[k];
      subtract_products<N>(work_[0].data(), pattern_.row.data(), lower_[0].data(), lower_[entry.position].data(),
                           entry.position, pattern_.begin[entry.column + 1]);
    }
    pivot_[j] = work_[j];
    if (!cholesky(pivot_[j])) return false;
    for (std::size_t p = pattern_.begin[j]; p < pattern_.begin[j + 1]; ++p) {
      lower_[p] = work_[pattern_.row[p]];
      solve_right(pivot_[j], lower_[p]);
    }
  }
  return true;
}

template <int N>
void BlockCholesky<N>::solve(std::vector<Vector>& x) {
  const std::size_t n = pattern_.at.size();
  for (std::size_t j = 0; j < n; ++j) y_[j] = x[pattern_.at[j]];
  for (std::size_t j = 0; j < n; ++j) {
    solve_lower(pivot_[j], y_[j]);
    for (std::size_t p = pattern_.begin[j]; p < pattern_.begin[j + 1]; ++p)
      y_[pattern_.row[p]].noalias() -= lower_[p] * y_[j];
  }
  for (std::size_t j = n; j-- > 0;) {
    for (std::size_t p = pattern_.begin[j]; p < pattern_.begin[j + 1]; ++p)
      y_[j].noalias() -= lower_[p].transpose() * y_[pattern_.row[p]];
    solve_upper(pivot_[j], y_[j]);
  }
  for (std::size_t j = 0; j < n; ++j) x[pattern_.at[j]] = y_[j];
}

template class BlockCholesky<6>;
template class BlockCholesky<3>;

}  // namespace epafi
