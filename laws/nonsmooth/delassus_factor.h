/// @file delassus_factor.h  Solves (I + D W) x = b for a block-diagonal D of 3 x 3 blocks: the linear system inside
/// every proximal, augmented-Lagrangian and ADMM step. In body form
///   x = b - D H^T y,  (M + H D H^T) y = H b,  W x = H^T y     (Woodbury)
/// so that a rank-deficient W never hurts: for symmetric positive semidefinite D the matrix is positive definite
/// (Cholesky), for the unsymmetric D of exact friction it is factored by LU. In local form I + D W is factored by LU.
#pragma once
#include "laws/nonsmooth/block_cholesky.h"
#include "laws/nonsmooth/block_lu.h"
#include "laws/nonsmooth/cone_problem.h"

namespace epafi {

class DelassusFactor {
 public:
  /// Finds order and pattern of the problem's graph; the problem must outlive its use.
  void attach(const ConeProblem& problem);
  /// False when the matrix is not positive definite to rounding.
  [[nodiscard]] bool factor(const std::vector<Mat3>& d, bool symmetric = true);
  /// x and w_x = W x.
  void solve(const std::vector<Vec3>& b, std::vector<Vec3>& x, std::vector<Vec3>& w_x);
  /// Block products of one factorisation, times the multiplications of one.
  double work() const;

 private:
  template <class Factor>
  bool factor_bodies(Factor& factor);
  bool factor_contacts();

  const ConeProblem* problem_ = nullptr;
  bool symmetric_ = true;
  BlockCholesky<6> bodies_;
  BlockLu<6> bodies_lu_;
  BlockLu<3> contacts_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;
  std::vector<std::uint32_t> edge_;  ///< body form: of each contact; local form: of each block of W
  std::vector<Mat3> d_;              ///< D
  std::vector<Vec6> y_;
};

}  // namespace epafi
