/// @file block_lu.h  Sparse LU factor of an unsymmetric matrix of N x N blocks with a symmetric pattern: the linear
/// systems of exact Coulomb friction, where a normal impulse makes a tangential one and not the other way round. Order
/// and storage as in block_cholesky.h, at twice its work. Rows are exchanged inside a pivot block, not between blocks.
#pragma once
#include "laws/nonsmooth/block_pattern.h"

namespace epafi {

template <int N>
class BlockLu {
 public:
  using Block = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  /// n block rows; edges (a, b), a != b, unique as unordered pairs. Keeps what it has if they are the same.
  void analyse(std::size_t n, const std::vector<BlockPattern::Edge>& edges);

  /// The matrix to fill before factor(): diagonal blocks, for edge e the block of rows a and columns b, and that of
  /// rows b and columns a.
  std::vector<Block> diagonal, lower, upper;

  /// False when a pivot block is singular or not finite.
  [[nodiscard]] bool factor();
  /// x = A^-1 x.
  void solve(std::vector<Vector>& x);
  /// Block products of one factorisation.
  double products() const { return 2.0 * pattern_.products; }

 private:
  void gather(const BlockPattern::Supernode& panel);
  void update(const BlockPattern::Supernode& panel);
  bool factor(const BlockPattern::Supernode& panel);

  BlockPattern pattern_;
  std::vector<Block> l_, u_;                ///< L on and below the diagonal; U right of it, each block transposed
  std::vector<Block> pivot_;                ///< inverse of the pivot blocks
  std::vector<std::uint32_t> row_, place_;  ///< of a place in the panel at work; of rows of another in its storage
  std::vector<Vector> y_;
};

extern template class BlockLu<6>;
extern template class BlockLu<3>;

}  // namespace epafi
