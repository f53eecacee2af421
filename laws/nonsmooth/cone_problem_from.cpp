/// Cone problems of matrices: the bodies are found in the pattern of M.
#include <Eigen/LU>
#include <algorithm>

#include "engine/units/error.h"
#include "laws/factors.h"
#include "laws/nonsmooth/cone_problem.h"

namespace epafi {

namespace {

using Index = Eigen::Index;
using Sparse = Eigen::SparseMatrix<double>;

/// Consecutive rows of M that no other row is coupled to, at most six of them: one body.
struct Groups {
  std::vector<std::uint32_t> of_row;
  std::vector<Index> first, count;
  bool found = true;
};

Groups find_bodies(const Sparse& m) {
  Groups g{std::vector<std::uint32_t>(static_cast<std::size_t>(m.rows())), {}, {}, true};
  std::vector<Index> reach(static_cast<std::size_t>(m.rows()));  // last row coupled to this one
  for (Index c = 0; c < m.cols(); ++c) {
    reach[static_cast<std::size_t>(c)] = std::max(reach[static_cast<std::size_t>(c)], c);
    for (Sparse::InnerIterator it(m, c); it; ++it) {
      const auto low = static_cast<std::size_t>(std::min(it.row(), c));
      if (it.value() != 0.0) reach[low] = std::max(reach[low], std::max(it.row(), c));
    }
  }
  for (Index begin = 0; begin < m.rows();) {
    Index end = begin;
    for (Index k = begin; k <= end; ++k) end = std::max(end, reach[static_cast<std::size_t>(k)]);
    const Index size = end - begin + 1;
    if (size > 6) return {.of_row = {}, .first = {}, .count = {}, .found = false};
    // six uncoupled rows of diagonal blocks belong together: translations and rotations of one rigid body
    const bool joins = !g.count.empty() && g.count.back() + size <= 6 && g.first.back() % 6 == 0;
    if (joins)
      g.count.back() += size;
    else {
      g.first.push_back(begin);
      g.count.push_back(size);
    }
    for (Index k = begin; k <= end; ++k)
      g.of_row[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(g.first.size() - 1);
    begin = end + 1;
  }
  return g;
}

/// False when some contact touches more than two bodies.
bool fill_rows(const Sparse& h, const Groups& g, ConeProblem& p) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    ConeProblem::Row& row = p.rows[i];
    for (auto& j : row.jacobian) j.setZero();
    for (int k = 0; k < 3; ++k)
      for (Sparse::InnerIterator it(h, 3 * static_cast<Index>(i) + k); it; ++it) {
        if (it.value() == 0.0) continue;
        const std::uint32_t body = g.of_row[static_cast<std::size_t>(it.row())];
        std::size_t s = 0;
        while (s < 2 && row.body[s] != body && row.body[s] != ConeProblem::no_body) ++s;
        if (s == 2) return false;
        row.body[s] = body;
        row.jacobian[s](it.row() - g.first[body], k) = it.value();
      }
  }
  return true;
}

ConeProblem from_w(const Sparse& w, const Eigen::VectorXd& q, const Eigen::VectorXd& mu) {
  ConeProblem p;
  const auto n = static_cast<std::size_t>(mu.size());
  p.friction.assign(mu.data(), mu.data() + n);
  p.q.resize(n);
  p.diagonal.assign(n, Mat3::Zero());
  p.begin.assign(1, 0);
  std::vector<std::uint32_t> seen;
  std::vector<Mat3> sum(n, Mat3::Zero());
  std::vector<char> marked(n, 0);
  for (std::size_t i = 0; i < n; ++i) {  // W is symmetric: columns are rows
    p.q[i] = q.segment<3>(3 * static_cast<Index>(i));
    seen.clear();
    for (int k = 0; k < 3; ++k)
      for (Sparse::InnerIterator it(w, 3 * static_cast<Index>(i) + k); it; ++it) {
        const auto j = static_cast<std::uint32_t>(it.row() / 3);
        if (!marked[j]) {
          marked[j] = 1;
          seen.push_back(j);
          sum[j].setZero();
        }
        sum[j](k, it.row() % 3) += it.value();
      }
    std::sort(seen.begin(), seen.end());
    for (const std::uint32_t j : seen) {
      marked[j] = 0;
      p.column.push_back(j);
      p.block.push_back(sum[j]);
      if (j == i) p.diagonal[i] = sum[j];
    }
    p.begin.push_back(p.column.size());
  }
  return p;
}

}  // namespace

ConeProblem ConeProblem::from(const LocalForm& form) { return from_w(form.W, form.q, form.mu); }

ConeProblem ConeProblem::from(const GlobalForm& form) {
  const Groups groups = find_bodies(form.M);
  ConeProblem p;
  const auto n = static_cast<std::size_t>(form.mu.size());
  p.friction.assign(form.mu.data(), form.mu.data() + n);
  p.rows.resize(n);
  if (!groups.found || !fill_rows(form.H, groups, p)) {
    SparseFactor factor;
    factor.compute(form.M);
    const Sparse x = factor.solve(form.H);
    Sparse w = form.H.transpose() * x;
    const Eigen::VectorXd velocity = factor.solve(Eigen::VectorXd(form.f));
    return from_w(w, form.H.transpose() * velocity + form.w, form.mu);
  }
  std::vector<Vec6> free(groups.first.size(), Vec6::Zero());
  p.mass.assign(groups.first.size(), Mat6::Identity());
  std::vector<Mat6> inverse(groups.first.size());
  for (std::size_t b = 0; b < groups.first.size(); ++b) {
    const Index first = groups.first[b], count = groups.count[b];
    p.mass[b].topLeftCorner(count, count) = Eigen::MatrixXd(form.M.block(first, first, count, count));
    inverse[b] = p.mass[b].inverse();
    free[b].head(count) = form.f.segment(first, count);
    free[b] = inverse[b] * free[b];
  }
  p.q.resize(n);
  p.diagonal.assign(n, Mat3::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    Row& row = p.rows[i];
    for (std::size_t s = 0; s < 2; ++s) {
      row.response[s].setZero();
      if (row.body[s] == no_body) continue;
      row.response[s] = inverse[row.body[s]] * row.jacobian[s];
      p.diagonal[i] += row.jacobian[s].transpose() * row.response[s];
    }
    p.q[i] = form.w.segment<3>(3 * static_cast<Index>(i)) + p.relative(i, free);
  }
  return p;
}

}  // namespace epafi
