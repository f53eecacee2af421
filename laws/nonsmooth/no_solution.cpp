#include "laws/nonsmooth/no_solution.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "laws/factors.h"

namespace epafi {

namespace {

constexpr double no_distance = 1e-7;          // of the normalised problem: a distance that counts as 0
constexpr double dependent = 1e-13;           // of a column's length: what is left of it is rounding
constexpr double machine_rounding = 2.2e-16;  // rounding

/// Columns of the least-squares problem: for contact i its row of W^(1/2) over its length, and below it q_N likewise.
struct NormalColumns {
  Eigen::MatrixXd a;
  std::vector<double> length;  ///< sqrt(W_NN) [kg^(-1/2)]
};

/// M^(-1/2) H_N of body-form contacts, so that W_NN is A^T A.
Eigen::MatrixXd body_columns(const ConeProblem& p, const std::vector<std::uint32_t>& chosen) {
  std::vector<std::uint32_t> place(p.bodies(), ConeProblem::no_body);
  Eigen::Index bodies = 0;
  for (const std::uint32_t i : chosen)
    for (const std::uint32_t b : p.rows[i].body)
      if (b != ConeProblem::no_body && place[b] == ConeProblem::no_body)
        place[b] = static_cast<std::uint32_t>(bodies++);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(6 * bodies, static_cast<Eigen::Index>(chosen.size()));
  for (std::size_t k = 0; k < chosen.size(); ++k)
    for (std::size_t s = 0; s < 2; ++s) {
      const ConeProblem::Row& row = p.rows[chosen[k]];
      if (row.body[s] == ConeProblem::no_body) continue;
      a.block<6, 1>(6 * static_cast<Eigen::Index>(place[row.body[s]]), static_cast<Eigen::Index>(k)) =
          solve_root(p.mass[row.body[s]], row.jacobian[s].col(0));
    }
  return a;
}

/// A root of the normal rows of a problem in blocks of W.
Eigen::MatrixXd block_columns(const ConeProblem& p, const std::vector<std::uint32_t>& chosen) {
  const auto n = static_cast<Eigen::Index>(chosen.size());
  std::vector<Eigen::Index> place(p.size(), -1);
  for (Eigen::Index k = 0; k < n; ++k) place[chosen[static_cast<std::size_t>(k)]] = k;
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::uint32_t i = chosen[static_cast<std::size_t>(k)];
    for (std::size_t b = p.begin[i]; b < p.begin[i + 1]; ++b)
      if (place[p.column[b]] >= 0) w(k, place[p.column[b]]) = p.block[b](0, 0);
  }
  return semidefinite_root(0.5 * (w + w.transpose()));
}

NormalColumns columns_of(const ConeProblem& p, const std::vector<std::uint32_t>& chosen) {
  NormalColumns out;
  const Eigen::MatrixXd a = p.has_bodies() ? body_columns(p, chosen) : block_columns(p, chosen);
  out.a.resize(a.rows() + 1, a.cols());
  out.a.topRows(a.rows()) = a;
  double largest = 0.0;
  for (Eigen::Index k = 0; k < a.cols(); ++k) {
    const std::uint32_t i = chosen[static_cast<std::size_t>(k)];
    out.length.push_back(std::sqrt(p.diagonal[i](0, 0)));
    out.a.col(k) /= out.length.back();
    out.a(a.rows(), k) = p.q[i].x() / out.length.back();
    largest = std::max(largest, std::abs(out.a(a.rows(), k)));
  }
  if (largest > 0.0) out.a.row(a.rows()) /= largest;
  return out;
}

/// Least |A z - b| over the held columns by the modified Gram-Schmidt process, backward stable (Bjorck 1967). A column
/// that depends on those before it gets 0.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const std::vector<Eigen::Index>& held, Eigen::VectorXd b) {
  const auto n = static_cast<Eigen::Index>(held.size());
  Eigen::MatrixXd q(a.rows(), n), upper = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd z = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    q.col(k) = a.col(held[static_cast<std::size_t>(k)]);
    const double whole = q.col(k).norm();
    for (Eigen::Index j = 0; j < k; ++j) {
      upper(j, k) = q.col(j).dot(q.col(k));
      q.col(k) -= upper(j, k) * q.col(j);
    }
    const double rest = q.col(k).norm();
    upper(k, k) = rest > dependent * whole ? rest : infinity;
    q.col(k) /= upper(k, k);
    z(k) = q.col(k).dot(b);
    b -= z(k) * q.col(k);
  }
  for (Eigen::Index k = n; k-- > 0;) {
    for (Eigen::Index j = k + 1; j < n; ++j) z(k) -= upper(k, j) * z(j);
    z(k) /= upper(k, k);
  }
  return z;
}

/// Least |A x - b| over x >= 0 by an active set (Lawson and Hanson 1974).
Eigen::VectorXd nonnegative_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  const Eigen::Index n = a.cols();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Index> held;
  for (Eigen::Index round = 0; round < 3 * n; ++round) {
    const Eigen::VectorXd rest = b - a * x;
    if (rest.norm() < no_distance) break;
    Eigen::Index best = -1;
    double pull = 1e-12;
    for (Eigen::Index k = 0; k < n; ++k)
      if (const double of_k = a.col(k).dot(rest); of_k > pull && std::find(held.begin(), held.end(), k) == held.end()) {
        best = k;
        pull = of_k;
      }
    if (best < 0) break;
    held.push_back(best);
    while (!held.empty()) {
      const Eigen::VectorXd z = least_squares(a, held, b);
      double step = 1.0;
      for (std::size_t k = 0; k < held.size(); ++k)
        if (const auto j = static_cast<Eigen::Index>(k); z(j) <= 0.0)
          step = std::min(step, x(held[k]) / std::max(x(held[k]) - z(j), 1e-300));
      for (std::size_t k = 0; k < held.size(); ++k) x(held[k]) += step * (z(static_cast<Eigen::Index>(k)) - x(held[k]));
      if (step >= 1.0) break;
      std::erase_if(held, [&](Eigen::Index k) {
        if (x(k) > 1e-14) return false;
        x(k) = 0.0;
        return true;
      });
    }
  }
  return x;
}

/// The contacts nearest to `first` by the bodies, or blocks, that they share.
std::vector<std::uint32_t> contacts_around(const ConeProblem& p, std::uint32_t first, std::size_t most) {
  std::vector<std::uint32_t> found{first};
  std::vector<char> is_in(p.size(), 0);
  is_in[first] = 1;
  const auto take = [&](std::uint32_t k) {
    if (is_in[k] || !p.moves(k) || found.size() >= most) return;
    is_in[k] = 1;
    found.push_back(k);
  };
  std::vector<std::vector<std::uint32_t>> of_body(p.bodies());
  for (std::uint32_t i = 0; i < p.rows.size(); ++i)
    for (const std::uint32_t b : p.rows[i].body)
      if (b != ConeProblem::no_body) of_body[b].push_back(i);
  for (std::size_t next = 0; next < found.size() && found.size() < most; ++next) {
    const std::uint32_t i = found[next];
    if (p.has_bodies()) {
      for (const std::uint32_t b : p.rows[i].body)
        if (b != ConeProblem::no_body) std::for_each(of_body[b].begin(), of_body[b].end(), take);
    } else if (!p.begin.empty()) {
      std::for_each(p.column.begin() + static_cast<std::ptrdiff_t>(p.begin[i]),
                    p.column.begin() + static_cast<std::ptrdiff_t>(p.begin[i + 1]), take);
    }
  }
  return found;
}

}  // namespace

std::string NoSolution::text() const {
  char number[48];
  std::snprintf(number, sizeof number, "%.4g m/s", closing);
  if (zero_row)
    return "zero row: no impulse moves contact " + std::to_string(contacts.front()) + " that closes with " + number;
  std::string names;
  for (std::size_t k = 0; k < contacts.size() && k < 6; ++k)
    names += (k == 0 ? "" : k + 1 == contacts.size() ? " and " : " ") + std::to_string(contacts[k]);
  if (contacts.size() > 6) names += " ... (" + std::to_string(contacts.size()) + ")";
  return "ray: contacts " + names + " close with " + number + " together whatever moves";
}

std::optional<NoSolution> find_no_solution(const ConeProblem& p, const std::vector<Vec3>& u, std::size_t most) {
  std::uint32_t worst = 0;
  bool any = false;
  for (std::uint32_t i = 0; i < p.size(); ++i) {
    if (!p.moves(i)) {
      if (p.q[i].x() < 0.0) return NoSolution{true, {i}, -p.q[i].x()};
      continue;
    }
    if (!any || u[i].x() < u[worst].x()) {
      worst = i;
      any = true;
    }
  }
  if (!any) return std::nullopt;
  const std::vector<std::uint32_t> chosen = contacts_around(p, worst, most);
  const NormalColumns c = columns_of(p, chosen);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(c.a.rows());
  b(b.size() - 1) = -1.0;
  const Eigen::VectorXd x = nonnegative_squares(c.a, b);
  if (!((c.a * x - b).norm() <= no_distance)) return std::nullopt;
  NoSolution out;
  double largest = 0.0, closing = 0.0;
  for (Eigen::Index k = 0; k < x.size(); ++k) largest = std::max(largest, x(k) / c.length[static_cast<std::size_t>(k)]);
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const double d = x(k) / c.length[static_cast<std::size_t>(k)] / largest;
    if (d < 1e-6) continue;
    out.contacts.push_back(chosen[static_cast<std::size_t>(k)]);
    closing -= d * p.q[out.contacts.back()].x();
  }
  std::sort(out.contacts.begin(), out.contacts.end());
  out.closing = closing;
  return out;
}

bool beyond_measure(const ConeProblem& p, const Impulses& r, double share) {
  double largest = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) largest = std::max(largest, p.diagonal[i](0, 0) * r[i].norm());
  return !(machine_rounding * largest <= share * p.q_norm());
}

}  // namespace epafi
