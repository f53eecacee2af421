/// @file block_cholesky.h  Sparse Cholesky factor of a symmetric positive definite matrix of N x N blocks, N = 6 (one
/// block per body) or 3 (one per contact): minimum-degree order of the graph of blocks, left-looking by block columns.
/// Order and pattern are found once per graph (N^2 times fewer entries than of the scalar matrix); factorising does no
/// allocation. Cost: linear on stacks and arches, N^3 multiplications per block product where the graph fills.
#pragma once
#include "laws/nonsmooth/block_pattern.h"

namespace epafi {

template <int N>
class BlockCholesky {
 public:
  using Block = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;
  /// n block rows; edges (a, b), a != b, unique as unordered pairs. Keeps what it has if they are the same.
  void analyse(std::size_t n, const std::vector<BlockPattern::Edge>& edges);

  /// The matrix to fill before factor(): diagonal blocks, and for edge e the block of rows a, columns b.
  std::vector<Block> diagonal, off_diagonal;

  /// False when a pivot is not positive.
  [[nodiscard]] bool factor();
  /// x = A^-1 x.
  void solve(std::vector<Vector>& x);

  /// Block products of one factorisation.
  double products() const { return pattern_.products; }

 private:
  void gather(const BlockPattern::Supernode& panel);
  void update(const BlockPattern::Supernode& panel);
  bool factor(const BlockPattern::Supernode& panel);

  BlockPattern pattern_;
  std::vector<Block> l_, pivot_;            ///< L in panels, and its diagonal
  std::vector<std::uint32_t> row_, place_;  ///< of a place in the panel at work; of rows of another in its storage
  std::vector<Vector> y_;
};

extern template class BlockCholesky<6>;
extern template class BlockCholesky<3>;

}  // namespace epafi
