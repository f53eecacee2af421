/// @file cone_sweep.h  Gauss-Seidel sweeps over a problem in blocks, in contact order and in sequence: for problem
/// files and for islands. Body form: 72 multiplications per contact and side; local form: one row of W. sweep.h is the
/// parallel twin for the contacts of a step.
#pragma once
#include "laws/nonsmooth/cone_problem.h"
#include "laws/nonsmooth/sweep.h"

namespace epafi {

template <LocalRule Rule>
class ConeSweep {
 public:
  void load(const ConeProblem& problem) {
    problem_ = &problem;
    data_.resize(problem.size());
    moving_.clear();
    for (std::uint32_t i = 0; i < problem.size(); ++i) {
      data_[i] = Rule::pack(problem.diagonal[i]);
      if (problem.moves(i)) moving_.push_back(i);
    }
  }
  /// Velocities of r; needed before the first run and after r was changed by others.
  void start(const Impulses& r) {
    if (problem_->has_bodies()) problem_->body_velocities(r, v_);
  }

  /// One update of every contact, upwards or downwards; returns the sum of |change of r|^2.
  double run(const Rule& rule, Impulses& r, bool upwards = true) {
    double sum = 0.0;
    const std::size_t n = moving_.size();
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = moving_[upwards ? k : n - 1 - k];
      sum += problem_->has_bodies() ? in_bodies(rule, i, r[i]) : in_row(rule, i, r);
    }
    return sum;
  }

 private:
  double in_bodies(const Rule& rule, std::size_t i, Vec3& r) {
    const ConeProblem::Row& row = problem_->rows[i];
    Vec3 u = problem_->q[i];
    for (std::size_t s = 0; s < 2; ++s)
      if (row.body[s] != ConeProblem::no_body) u.noalias() += row.jacobian[s].transpose() * v_[row.body[s]];
    const Vec3 next = rule.update(data_[i], problem_->friction[i], r, u), d = next - r;
    r = next;
    for (std::size_t s = 0; s < 2; ++s)
      if (row.body[s] != ConeProblem::no_body) v_[row.body[s]].noalias() += row.response[s] * d;
    return d.squaredNorm();
  }

  double in_row(const Rule& rule, std::size_t i, Impulses& r) {
    const ConeProblem& p = *problem_;
    Vec3 u = p.q[i];
    for (std::size_t k = p.begin[i]; k < p.begin[i + 1]; ++k) u.noalias() += p.block[k] * r[p.column[k]];
    const Vec3 next = rule.update(data_[i], p.friction[i], r[i], u), d = next - r[i];
    r[i] = next;
    return d.squaredNorm();
  }

  const ConeProblem* problem_ = nullptr;
  std::vector<typename Rule::Data> data_;
  std::vector<std::uint32_t> moving_;  ///< contacts that an impulse moves
  std::vector<Vec6> v_;
};

}  // namespace epafi
