#include "laws/nonsmooth/block_cholesky.h"

#include <algorithm>
#include <cmath>

#include "laws/nonsmooth/block_product.h"
#include "laws/nonsmooth/panels.h"

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
  diagonal.resize(n);
  off_diagonal.resize(edges.size());
  l_.resize(pattern_.blocks() + 1);
  pivot_.resize(n);
  row_.resize(n);
  place_.resize(n);
  y_.resize(n);
}

/// Columns of A on and below the diagonal, into the panel.
template <int N>
void BlockCholesky<N>::gather(const BlockPattern::Supernode& panel) {
  Block* l = l_.data() + panel.blocks;
  std::fill_n(l->data(), panel.height() * panel.width * N * N, 0.0);
  for (std::uint32_t i = 0; i < panel.width; ++i) l[i * panel.width + i] = diagonal[pattern_.at[panel.first + i]];
  for_each_edge(pattern_, panel, row_, [&](std::size_t e, std::size_t to, bool swapped) {
    if (swapped)
      l[to] = off_diagonal[e];  // rows of the later one
    else
      l[to] = off_diagonal[e].transpose();
  });
}

/// What earlier panels take from this one.
template <int N>
void BlockCholesky<N>::update(const BlockPattern::Supernode& panel) {
  for (std::size_t k = panel.updates; k < panel.updates_end; ++k) {
    const BlockPattern::Update& from = pattern_.updates[k];
    const BlockPattern::Supernode& other = pattern_.supernodes[from.supernode];
    const std::uint32_t* rows = pattern_.row.data() + other.rows;
    const Block* l = l_.data() + other.blocks;
    for (std::size_t i = from.first; i < other.height(); ++i) place_[i] = row_[rows[i]] * panel.width;
    for (std::size_t j = from.first; j < from.last; ++j)
      subtract_panels<N>({l_[panel.blocks + rows[j] - panel.first].data(), place_.data(), l->data(),
                          l[j * other.width].data(), j, other.height(), other.width, other.width});
  }
}

/// The panel itself, column by column.
template <int N>
bool BlockCholesky<N>::factor(const BlockPattern::Supernode& panel) {
  const std::size_t width = panel.width, height = panel.height();
  Block* l = l_.data() + panel.blocks;
  for (std::size_t i = 0; i < height; ++i) place_[i] = static_cast<std::uint32_t>(i * width);
  for (std::size_t j = 0; j < width; ++j) {
    subtract_panels<N>({l[j].data(), place_.data(), l->data(), l[j * width].data(), j, height, width, j});
    Block& pivot = pivot_[panel.first + j];
    pivot = l[j * width + j];
    if (!cholesky(pivot)) return false;
    for (std::size_t i = j + 1; i < height; ++i) solve_right(pivot, l[i * width + j]);
  }
  return true;
}

template <int N>
bool BlockCholesky<N>::factor() {
  return std::all_of(pattern_.supernodes.begin(), pattern_.supernodes.end(), [&](const auto& panel) {
    gather(panel);
    update(panel);
    return factor(panel);
  });
}

template <int N>
void BlockCholesky<N>::solve(std::vector<Vector>& x) {
  const std::size_t n = pattern_.size();
  for (std::size_t j = 0; j < n; ++j) y_[j] = x[pattern_.at[j]];
  for (const BlockPattern::Supernode& panel : pattern_.supernodes) {
    const std::uint32_t* rows = pattern_.row.data() + panel.rows;
    const Block* l = l_.data() + panel.blocks;
    for (std::size_t j = 0; j < panel.width; ++j) {
      const Vector& y = y_[panel.first + j];
      solve_lower(pivot_[panel.first + j], y_[panel.first + j]);
      for (std::size_t i = j + 1; i < panel.height(); ++i) y_[rows[i]].noalias() -= l[i * panel.width + j] * y;
    }
  }
  substitute_back(pattern_, l_, y_, [&](std::size_t j, Vector& y) { solve_upper(pivot_[j], y); });
  for (std::size_t j = 0; j < n; ++j) x[pattern_.at[j]] = y_[j];
}

template class BlockCholesky<6>;
template class BlockCholesky<3>;

}  // namespace epafi
