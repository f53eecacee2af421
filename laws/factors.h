/// @file factors.h  Factorisations and products of large matrices, compiled once: each takes one to five seconds in
/// every file that instantiates it. A vector on the right side and a matrix of one column round differently.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>

namespace epafi {

/// a b and a^T b.
Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
Eigen::MatrixXd transposed_product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// LU with partial pivoting.
Eigen::VectorXd solve_lu(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::MatrixXd solve_lu(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// L D L^T of a symmetric semidefinite matrix.
Eigen::VectorXd solve_ldlt(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// (L L^T)^-1 x, or L^-1 x, of a positive definite matrix L L^T.
using Six = Eigen::Matrix<double, 6, 1>;
Six solve_llt(const Eigen::Matrix<double, 6, 6>& a, const Six& x);
Six solve_root(const Eigen::Matrix<double, 6, 6>& a, const Six& x);

/// A of A^T A = w, w symmetric semidefinite but for rounding.
Eigen::MatrixXd semidefinite_root(const Eigen::MatrixXd& w);

/// L D L^T of a sparse matrix, positive definite, for many right sides.
class SparseFactor {
 public:
  using Sparse = Eigen::SparseMatrix<double>;
  SparseFactor();
  ~SparseFactor();
  void compute(const Sparse& a);
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  Sparse solve(const Sparse& b) const;

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace epafi
