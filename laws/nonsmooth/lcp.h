/// @file lcp.h  Linear complementarity problems, dense: w = M z + q, 0 <= w, 0 <= z, w.z = 0 (Cottle, Pang and Stone
/// 1992). The textbook methods, each with its report: what it counts, the residual ||min(z, M z + q)||_inf, and for
/// Lemke a certificate when it ends on a ray. Memory n^2; a factorisation or pivot costs n^2 to n^3.
#pragma once
#include <Eigen/Core>
#include <functional>

namespace epafi {

struct LcpProblem {
  Eigen::MatrixXd M;
  Eigen::VectorXd q;
};

enum class LcpStatus {
  solved,
  ray,      ///< Lemke: unbounded ray; for copositive M (all of contact) the problem is then infeasible
  limit,    ///< ran out of iterations or pivots
  stalled,  ///< no further progress, or a singular matrix
};

struct LcpReport {
  LcpStatus status = LcpStatus::limit;
  int iterations = 0;     ///< pivots, sweeps or Newton steps
  double residual = 0.0;  ///< ||min(z, M z + q)||_inf
};

struct LcpSettings {
  int iterations = 10000;
  double tolerance = 1e-12;  ///< of the residual, relative to max|q|
  std::function<bool()> interrupted{};
};

/// ||min(z, M z + q)||_inf.
[[nodiscard]] double lcp_residual(const LcpProblem& problem, const Eigen::VectorXd& z);

using LcpMethod = LcpReport (*)(const LcpProblem&, const LcpSettings&, Eigen::VectorXd& z);

/// Lemke's complementary pivoting with an irregular covering vector and a lexicographic ratio test, so that degenerate
/// problems cannot cycle (Cottle, Pang and Stone 1992, 4.4 and 4.9). Ignores the start z.
LcpReport lemke(const LcpProblem& problem, const LcpSettings& settings, Eigen::VectorXd& z);
/// Dantzig's principal pivoting: one index after the other is driven to complementarity while those before keep theirs
/// (Cottle and Dantzig 1968; Baraff 1994). For symmetric positive semidefinite M. Ignores the start z.
LcpReport dantzig(const LcpProblem& problem, const LcpSettings& settings, Eigen::VectorXd& z);
/// Projected gradient with the step of Barzilai and Borwein (1988), kept a descent. For symmetric M.
LcpReport projected_gradient(const LcpProblem& problem, const LcpSettings& settings, Eigen::VectorXd& z);
/// Conjugate gradients on the free face, with gradient projection steps to change it (Dostal 1997). For symmetric M.
LcpReport conjugate_projected_gradient(const LcpProblem& problem, const LcpSettings& settings, Eigen::VectorXd& z);
/// Semismooth Newton on min(z, M z + q) (Kanzow 1996), with the Fischer-Burmeister function as merit.
LcpReport newton_min(const LcpProblem& problem, const LcpSettings& settings, Eigen::VectorXd& z);
/// Semismooth Newton on z + w - sqrt(z^2 + w^2) (Fischer 1992; De Luca, Facchinei and Kanzow 1996).
LcpReport fischer_burmeister(const LcpProblem& problem, const LcpSettings& settings, Eigen::VectorXd& z);
/// Projected Gauss-Seidel, for comparison.
LcpReport projected_gauss_seidel(const LcpProblem& problem, const LcpSettings& settings, Eigen::VectorXd& z);

}  // namespace epafi
