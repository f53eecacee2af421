#include "laws/factors.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <cmath>

namespace epafi {

Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a * b; }
Eigen::MatrixXd transposed_product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a.transpose() * b; }

Eigen::VectorXd solve_lu(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) { return a.partialPivLu().solve(b); }
Eigen::MatrixXd solve_lu(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a.partialPivLu().solve(b); }
Eigen::VectorXd solve_ldlt(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) { return a.ldlt().solve(b); }
Six solve_llt(const Eigen::Matrix<double, 6, 6>& a, const Six& x) { return a.llt().solve(x); }
Six solve_root(const Eigen::Matrix<double, 6, 6>& a, const Six& x) { return a.llt().matrixL().solve(x); }

Eigen::MatrixXd semidefinite_root(const Eigen::MatrixXd& w) {
  const Eigen::LDLT<Eigen::MatrixXd> factor(w);
  const double largest = factor.vectorD().cwiseAbs().maxCoeff();
  const Eigen::VectorXd roots =
      factor.vectorD().unaryExpr([&](double x) { return x > 1e-14 * largest ? std::sqrt(x) : 0.0; });
  Eigen::MatrixXd lower = factor.matrixL();
  lower = factor.transpositionsP().transpose() * lower;
  return roots.asDiagonal() * lower.transpose();
}

struct SparseFactor::Solver {
  Eigen::SimplicialLDLT<Sparse> factor;
};
SparseFactor::SparseFactor() : solver_(std::make_unique<Solver>()) {}
SparseFactor::~SparseFactor() = default;
void SparseFactor::compute(const Sparse& a) { solver_->factor.compute(a); }
Eigen::VectorXd SparseFactor::solve(const Eigen::VectorXd& b) const { return solver_->factor.solve(b); }
SparseFactor::Sparse SparseFactor::solve(const Sparse& b) const { return solver_->factor.solve(b); }

}  // namespace epafi
