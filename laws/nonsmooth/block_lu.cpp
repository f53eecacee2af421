#include "laws/nonsmooth/block_lu.h"

#include <Eigen/LU>
#include <algorithm>

#include "laws/nonsmooth/block_product.h"
#include "laws/nonsmooth/panels.h"

namespace epafi {

template <int N>
void BlockLu<N>::analyse(std::size_t n, const std::vector<BlockPattern::Edge>& edges) {
  pattern_.analyse(n, edges);
  diagonal.resize(n);
  lower.resize(edges.size());
  upper.resize(edges.size());
  l_.resize(pattern_.blocks() + 1);
  u_.resize(pattern_.blocks() + 1);
  pivot_.resize(n);
  y_.resize(n);
  row_.resize(n);
  place_.resize(n);
}

/// Columns of A on and below the diagonal and rows right of it, into the panel.
template <int N>
void BlockLu<N>::gather(const BlockPattern::Supernode& panel) {
  Block* l = l_.data() + panel.blocks;
  Block* u = u_.data() + panel.blocks;
  std::fill_n(l->data(), panel.height() * panel.width * N * N, 0.0);
  std::fill_n(u->data(), panel.height() * panel.width * N * N, 0.0);
  for (std::uint32_t i = 0; i < panel.width; ++i) l[i * panel.width + i] = diagonal[pattern_.at[panel.first + i]];
  for_each_edge(pattern_, panel, row_, [&](std::size_t e, std::size_t to, bool swapped) {
    l[to] = swapped ? lower[e] : upper[e];
    u[to] = swapped ? upper[e].transpose() : lower[e].transpose();
  });
}

/// What earlier panels take from this one.
template <int N>
void BlockLu<N>::update(const BlockPattern::Supernode& panel) {
  for (std::size_t k = panel.updates; k < panel.updates_end; ++k) {
    const BlockPattern::Update& from = pattern_.updates[k];
    const BlockPattern::Supernode& other = pattern_.supernodes[from.supernode];
    const std::uint32_t* rows = pattern_.row.data() + other.rows;
    const Block *l = l_.data() + other.blocks, *u = u_.data() + other.blocks;
    for (std::size_t i = from.first; i < other.height(); ++i) place_[i] = row_[rows[i]] * panel.width;
    for (std::size_t j = from.first; j < from.last; ++j) {
      const std::size_t to = panel.blocks + rows[j] - panel.first;
      const Block *l_j = l + j * other.width, *u_j = u + j * other.width;
      subtract_panels<N>(
          {l_[to].data(), place_.data(), l->data(), u_j->data(), j, other.height(), other.width, other.width});
      subtract_panels<N>(
          {u_[to].data(), place_.data(), u->data(), l_j->data(), j + 1, other.height(), other.width, other.width});
    }
  }
}

/// The panel itself, column by column.
template <int N>
bool BlockLu<N>::factor(const BlockPattern::Supernode& panel) {
  const std::size_t width = panel.width, height = panel.height();
  Block* l = l_.data() + panel.blocks;
  Block* u = u_.data() + panel.blocks;
  for (std::size_t i = 0; i < height; ++i) place_[i] = static_cast<std::uint32_t>(i * width);
  for (std::size_t j = 0; j < width; ++j) {
    subtract_panels<N>({l[j].data(), place_.data(), l->data(), u[j * width].data(), j, height, width, j});
    subtract_panels<N>({u[j].data(), place_.data(), u->data(), l[j * width].data(), j + 1, height, width, j});
    Block& pivot = pivot_[panel.first + j];
    pivot = Eigen::PartialPivLU<Block>(l[j * width + j]).inverse();
    if (!pivot.allFinite()) return false;
    for (std::size_t i = j + 1; i < height; ++i) l[i * width + j] = (l[i * width + j] * pivot).eval();
  }
  return true;
}

template <int N>
bool BlockLu<N>::factor() {
  return std::all_of(pattern_.supernodes.begin(), pattern_.supernodes.end(), [&](const auto& panel) {
    gather(panel);
    update(panel);
    return factor(panel);
  });
}

template <int N>
void BlockLu<N>::solve(std::vector<Vector>& x) {
  const std::size_t n = pattern_.size();
  for (std::size_t j = 0; j < n; ++j) y_[j] = x[pattern_.at[j]];
  for (const BlockPattern::Supernode& panel : pattern_.supernodes) {
    const std::uint32_t* rows = pattern_.row.data() + panel.rows;
    const Block* l = l_.data() + panel.blocks;
    for (std::size_t i = 1; i < panel.height(); ++i)
      for (std::size_t j = 0; j < std::min<std::size_t>(i, panel.width); ++j)
        y_[rows[i]].noalias() -= l[i * panel.width + j] * y_[panel.first + j];
  }
  substitute_back(pattern_, u_, y_, [&](std::size_t j, Vector& y) { y = (pivot_[j] * y).eval(); });
  for (std::size_t j = 0; j < n; ++j) x[pattern_.at[j]] = y_[j];
}

template class BlockLu<6>;
template class BlockLu<3>;

}  // namespace epafi
