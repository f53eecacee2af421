/// Pivoting methods for linear complementarity problems.
#include <algorithm>
#include <vector>

#include "engine/units/random.h"
#include "laws/factors.h"
#include "laws/nonsmooth/lcp.h"

namespace epafi {

namespace {

using Index = Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

LcpReport finish(const LcpProblem& p, const LcpSettings& s, LcpReport report, const VectorXd& z) {
  report.residual = lcp_residual(p, z);
  const double scale = std::max(1e-300, p.q.cwiseAbs().maxCoeff());
  if (report.status == LcpStatus::solved && !(report.residual <= std::max(s.tolerance, 1e-9) * scale))
    report.status = LcpStatus::stalled;
  return report;
}

/// The covering vector: irregular in [1, 2], the same in every run. With a vector of ones Lemke's path visits 2^n bases
/// on the problems of Murty and Fathi (n = 64: over 20000 pivots); along an irregular direction it is short.
double cover(Index i) { return Random(2026, static_cast<std::uint64_t>(i)).uniform(1.0, 2.0); }

/// Rows of [1, -M, -d | q, 1]: basis w at the start; columns 0..n-1 w, n..2n-1 z, 2n the artificial z0.
class Tableau {
 public:
  explicit Tableau(const LcpProblem& p) : n(p.q.size()), rows(n, 3 * n + 2), basis(static_cast<std::size_t>(n)) {
    rows.setZero();
    rows.leftCols(n).setIdentity();
    rows.middleCols(n, n) = -p.M;
    for (Index i = 0; i < n; ++i) rows(i, 2 * n) = -cover(i);
    rows.col(2 * n + 1) = p.q;
    rows.rightCols(n).setIdentity();  // what makes ties break lexicographically: the rows of the inverse of the basis
    for (Index i = 0; i < n; ++i) basis[static_cast<std::size_t>(i)] = i;
  }
  /// Row r_i is lexicographically smaller than r_j when both are divided by their entries of `column`.
  bool smaller(Index i, Index j, Index column) const {
    const double a = rows(i, column), b = rows(j, column);
    for (Index k = 2 * n + 1; k < rows.cols(); ++k) {
      const double x = rows(i, k) / a, y = rows(j, k) / b, size = std::max({std::abs(x), std::abs(y), 1e-300});
      if (std::abs(x - y) > 1e-12 * std::max(size, 1e-12)) return x < y;
    }
    return false;
  }
  void pivot(Index row, Index column) {
    rows.row(row) /= rows(row, column);
    for (Index i = 0; i < n; ++i) {
      if (i == row) continue;
      const double f = rows(i, column);
      if (f != 0.0) rows.row(i) -= f * rows.row(row);
      rows(i, column) = 0.0;
    }
    basis[static_cast<std::size_t>(row)] = column;
  }
  /// The row that leaves when `column` enters, -1 on a ray. A row of z0 that ties leaves.
  Index leaving(Index column) const {
    const double least = 1e-11 * std::max(1.0, rows.col(column).cwiseAbs().maxCoeff());
    Index best = -1;
    for (Index i = 0; i < n; ++i) {
      if (rows(i, column) <= least) continue;
      if (best < 0 || smaller(i, best, column)) best = i;
    }
    if (best < 0) return best;
    const double ratio = rows(best, 2 * n + 1) / rows(best, column);
    for (Index i = 0; i < n; ++i)
      if (basis[static_cast<std::size_t>(i)] == 2 * n && rows(i, column) > least &&
          rows(i, 2 * n + 1) / rows(i, column) <= ratio + 1e-14)
        return i;
    return best;
  }

  Index n;
  MatrixXd rows;
  std::vector<Index> basis;
};

}  // namespace

double lcp_residual(const LcpProblem& p, const VectorXd& z) {
  return p.q.size() == 0 ? 0.0 : z.cwiseMin(p.M * z + p.q).cwiseAbs().maxCoeff();
}

LcpReport lemke(const LcpProblem& p, const LcpSettings& s, VectorXd& z) {
  const Index n = p.q.size();
  z = VectorXd::Zero(n);
  if (n == 0 || p.q.minCoeff() >= 0.0) return finish(p, s, {LcpStatus::solved, 0, 0.0}, z);
  Tableau t(p);
  Index row = 0;
  for (Index i = 1; i < n; ++i)
    if (p.q[i] / cover(i) < p.q[row] / cover(row)) row = i;
  Index entering = 2 * n;
  LcpReport report;
  while (true) {
    const Index left = t.basis[static_cast<std::size_t>(row)];
    t.pivot(row, entering);
    ++report.iterations;
    if (left == 2 * n) {
      report.status = LcpStatus::solved;
      break;
    }
    if (report.iterations >= s.iterations || (s.interrupted && s.interrupted())) break;
    entering = left < n ? left + n : left - n;  // the complement of what left
    row = t.leaving(entering);
    if (row < 0) {
      report.status = LcpStatus::ray;
      break;
    }
  }
  for (Index i = 0; i < n; ++i) {
    const Index v = t.basis[static_cast<std::size_t>(i)];
    if (v >= n && v < 2 * n) z[v - n] = std::max(0.0, t.rows(i, 2 * n + 1));
  }
  return finish(p, s, report, z);
}

namespace {

/// State of Dantzig's method: z and w of all indices; `basic` marks those with w = 0 that carry z.
struct Principal {
  const LcpProblem& p;
  VectorXd z, w;
  std::vector<Index> basic;

  /// Change of the basic z per unit of z_i that keeps their w at 0; false when their matrix is singular.
  bool direction(Index i, VectorXd& dz) const {
    const auto k = static_cast<Index>(basic.size());
    dz = VectorXd::Zero(z.size());
    dz[i] = 1.0;
    if (k == 0) return true;
    const MatrixXd m = p.M(basic, basic);
    const VectorXd rhs = -p.M(basic, std::vector<Index>{i});
    const VectorXd x = solve_ldlt(m, rhs);
    if (!x.allFinite() || (m * x - rhs).norm() > 1e-8 * (1.0 + rhs.norm())) return false;
    for (Index j = 0; j < k; ++j) dz[basic[static_cast<std::size_t>(j)]] = x[j];
    return true;
  }

  /// Moves along dz as far as the signs allow, w_i up to 0; the first that blocks changes sides. False when nothing
  /// does.
  bool advance(Index i, const VectorXd& dz, const std::vector<char>& settled) {
    const VectorXd dw = p.M * dz;
    // a semidefinite M with redundant rows: w_i can no longer move and stays below 0 only if infeasible
    double step = dw[i] > 1e-14 * std::abs(p.M(i, i)) ? -w[i] / dw[i] : -1.0;
    Index blocking = -1;
    bool leaves = false;
    const auto block = [&](double t, Index j, bool out) {
      if (step < 0.0 || t < step) {
        step = t;
        blocking = j;
        leaves = out;
      }
    };
    for (const Index j : basic)
      if (dz[j] < -1e-14) block(std::max(0.0, -z[j] / dz[j]), j, true);
    for (Index j = 0; j < i; ++j)
      if (settled[static_cast<std::size_t>(j)] && z[j] == 0.0 && dw[j] < -1e-14 &&
          std::find(basic.begin(), basic.end(), j) == basic.end())
        block(std::max(0.0, -w[j] / dw[j]), j, false);
    if (step < 0.0) return false;
    z += step * dz;
    w += step * dw;
    if (blocking < 0) {
      w[i] = 0.0;
      basic.push_back(i);
    } else if (leaves) {
      z[blocking] = 0.0;
      basic.erase(std::find(basic.begin(), basic.end(), blocking));
    } else {
      w[blocking] = 0.0;
      basic.push_back(blocking);
    }
    return true;
  }
};

}  // namespace

LcpReport dantzig(const LcpProblem& p, const LcpSettings& s, VectorXd& z) {
  const Index n = p.q.size();
  const double tiny = 1e-13 * std::max(1e-300, n > 0 ? p.q.cwiseAbs().maxCoeff() : 0.0);
  Principal state{p, VectorXd::Zero(n), p.q, {}};
  LcpReport report{LcpStatus::solved, 0, 0.0};
  std::vector<char> settled(static_cast<std::size_t>(n), 0);
  VectorXd dz;
  for (Index i = 0; i < n && report.status == LcpStatus::solved; ++i) {
    while (state.w[i] < -tiny) {
      if (++report.iterations >= s.iterations || (s.interrupted && s.interrupted())) {
        report.status = LcpStatus::limit;
        break;
      }
      if (!state.direction(i, dz)) {
        report.status = LcpStatus::stalled;
        break;
      }
      if (!state.advance(i, dz, settled)) {
        report.status = LcpStatus::ray;
        break;
      }
    }
    settled[static_cast<std::size_t>(i)] = 1;
  }
  z = state.z;
  return finish(p, s, report, z);
}

}  // namespace epafi
