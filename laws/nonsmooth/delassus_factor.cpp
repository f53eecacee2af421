#include "laws/nonsmooth/delassus_factor.h"

#include <algorithm>

namespace epafi {

namespace {

constexpr std::uint32_t none = ConeProblem::no_body;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge edge_of(const ConeProblem::Row& row) {
  return {std::max(row.body[0], row.body[1]), std::min(row.body[0], row.body[1])};
}

bool joins_two(const ConeProblem::Row& row) {
  return row.body[0] != none && row.body[1] != none && row.body[0] != row.body[1];
}

}  // namespace

void DelassusFactor::attach(const ConeProblem& problem) {
  problem_ = &problem;
  edges_.clear();
  edge_.clear();
  const std::size_t n = problem.size();
  if (problem.has_bodies()) {
    for (const auto& row : problem.rows)
      if (joins_two(row)) edges_.push_back(edge_of(row));
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    edge_.assign(n, none);
    for (std::size_t i = 0; i < n; ++i) {
      if (!joins_two(problem.rows[i])) continue;
      const auto it = std::lower_bound(edges_.begin(), edges_.end(), edge_of(problem.rows[i]));
      edge_[i] = static_cast<std::uint32_t>(it - edges_.begin());
    }
    bodies_.analyse(problem.bodies(), edges_);
    bodies_lu_.analyse(problem.bodies(), edges_);
    return;
  }
  edge_.assign(problem.column.size(), none);
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::size_t k = problem.begin[i]; k < problem.begin[i + 1]; ++k)
      if (problem.column[k] < i) {
        edge_[k] = static_cast<std::uint32_t>(edges_.size());
        edges_.push_back({i, problem.column[k]});
      }
  contacts_.analyse(n, edges_);
}

double DelassusFactor::work() const {
  return problem_->has_bodies() ? 216.0 * bodies_.products() : 27.0 * contacts_.products();
}

bool DelassusFactor::factor(const std::vector<Mat3>& d, bool symmetric) {
  d_ = d;
  symmetric_ = symmetric;
  if (!problem_->has_bodies()) return factor_contacts();
  return symmetric ? factor_bodies(bodies_) : factor_bodies(bodies_lu_);
}

/// Fills and factors M + H D H^T.
template <class Factor>
bool DelassusFactor::factor_bodies(Factor& factor) {
  constexpr bool full = requires { factor.upper; };
  const auto clear = [](auto& blocks) {
    for (Mat6& block : blocks) block.setZero();
  };
  std::copy(problem_->mass.begin(), problem_->mass.end(), factor.diagonal.begin());
  if constexpr (full) {
    clear(factor.lower);
    clear(factor.upper);
  } else
    clear(factor.off_diagonal);
  for (std::size_t i = 0; i < problem_->size(); ++i) {
    if (d_[i].isZero(0.0)) continue;
    const ConeProblem::Row& row = problem_->rows[i];
    for (std::size_t s = 0; s < 2; ++s) {
      if (row.body[s] == none) continue;
      const Mat63 hd = row.jacobian[s] * d_[i];
      factor.diagonal[row.body[s]].noalias() += hd * row.jacobian[s].transpose();
      const std::uint32_t other = row.body[1 - s];
      if (other == none) continue;
      if (other == row.body[s]) {
        factor.diagonal[other].noalias() += hd * row.jacobian[1 - s].transpose();
      } else if constexpr (full) {
        auto& block = row.body[s] > other ? factor.lower[edge_[i]] : factor.upper[edge_[i]];
        block.noalias() += hd * row.jacobian[1 - s].transpose();
      } else if (row.body[s] > other) {
        factor.off_diagonal[edge_[i]].noalias() += hd * row.jacobian[1 - s].transpose();
      }
    }
  }
  return factor.factor();
}

/// Fills and factors I + D W.
bool DelassusFactor::factor_contacts() {
  const ConeProblem& p = *problem_;
  for (std::uint32_t i = 0; i < p.size(); ++i) {
    contacts_.diagonal[i].setIdentity();
    for (std::size_t k = p.begin[i]; k < p.begin[i + 1]; ++k) {
      const std::uint32_t j = p.column[k];
      if (j > i) continue;
      if (j == i) {
        contacts_.diagonal[i] += d_[i] * p.block[k];
      } else {
        contacts_.lower[edge_[k]] = d_[i] * p.block[k];
        contacts_.upper[edge_[k]] = d_[j] * p.block[k].transpose();
      }
    }
  }
  return contacts_.factor();
}

void DelassusFactor::solve(const std::vector<Vec3>& b, std::vector<Vec3>& x, std::vector<Vec3>& w_x) {
  const ConeProblem& p = *problem_;
  x.resize(p.size());
  w_x.resize(p.size());
  if (p.has_bodies()) {
    y_.assign(p.bodies(), Vec6::Zero());
    for (std::size_t i = 0; i < p.size(); ++i)
      for (std::size_t s = 0; s < 2; ++s)
        if (p.rows[i].body[s] != none) y_[p.rows[i].body[s]].noalias() += p.rows[i].jacobian[s] * b[i];
    if (symmetric_)
      bodies_.solve(y_);
    else
      bodies_lu_.solve(y_);
    for (std::size_t i = 0; i < p.size(); ++i) {
      w_x[i] = p.relative(i, y_);
      x[i] = b[i] - d_[i] * w_x[i];
    }
    return;
  }
  const auto times_w = [&](const std::vector<Vec3>& in, std::size_t i) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = p.begin[i]; k < p.begin[i + 1]; ++k) sum.noalias() += p.block[k] * in[p.column[k]];
    return sum;
  };
  x = b;
  contacts_.solve(x);
  for (std::size_t i = 0; i < p.size(); ++i) w_x[i] = times_w(x, i);
}

}  // namespace epafi
