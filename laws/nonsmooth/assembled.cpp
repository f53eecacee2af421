#include "laws/nonsmooth/assembled.h"

#include <Eigen/LU>

namespace epafi {

namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;
using Index = Eigen::Index;

/// First row of every free body, -1 for the others; and the number of rows.
struct Rows {
  std::vector<Index> first;
  Index count = 0;
};

Rows rows_of(const ContactProblem& problem) {
  Rows rows{std::vector<Index>(problem.inverse_mass.size(), -1), 0};
  for (Slot s = 0; s < problem.inverse_mass.size(); ++s) {
    if (!problem.is_free(s)) continue;
    rows.first[s] = rows.count;
    rows.count += problem.rotates ? 6 : 3;
  }
  return rows;
}

template <class Block>
void add_block(Triplets& out, Index row, Index col, const Block& block) {
  for (Index i = 0; i < block.rows(); ++i)
    for (Index j = 0; j < block.cols(); ++j)
      if (block(i, j) != 0.0) out.emplace_back(row + i, col + j, block(i, j));
}

Eigen::SparseMatrix<double> to_matrix(Index rows, Index cols, const Triplets& entries) {
  Eigen::SparseMatrix<double> matrix(rows, cols);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// M, or its inverse.
Eigen::SparseMatrix<double> mass_matrix(const ContactProblem& problem, const Rows& rows, bool inverse) {
  Triplets entries;
  for (Slot s = 0; s < rows.first.size(); ++s) {
    if (rows.first[s] < 0) continue;
    const double m = inverse ? problem.inverse_mass[s] : 1.0 / problem.inverse_mass[s];
    add_block(entries, rows.first[s], rows.first[s], Mat3(m * Mat3::Identity()));
    if (!problem.rotates) continue;
    const Mat3& j = problem.inverse_inertia[s];
    add_block(entries, rows.first[s] + 3, rows.first[s] + 3, inverse ? j : Mat3(j.inverse()));
  }
  return to_matrix(rows.count, rows.count, entries);
}

Eigen::SparseMatrix<double> jacobian(const ContactProblem& problem, const Rows& rows) {
  Triplets entries;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    Mat3 axes, lever;
    axes << problem.frame[i].normal, problem.frame[i].tangent1, problem.frame[i].tangent2;
    const auto add = [&](Slot body, double sign) {
      const Index row = rows.first[body], col = 3 * static_cast<Index>(i);
      if (row < 0) return;
      add_block(entries, row, col, Mat3(sign * axes));
      if (!problem.rotates) return;
      const Vec3& arm = sign > 0.0 ? problem.arm_b[i] : problem.arm_a[i];
      for (int k = 0; k < 3; ++k) lever.col(k) = sign * arm.cross(axes.col(k));
      add_block(entries, row + 3, col, lever);
    };
    add(problem.a[i], -1.0);
    add(problem.b[i], 1.0);
  }
  return to_matrix(rows.count, 3 * static_cast<Index>(problem.size()), entries);
}

Eigen::VectorXd free_velocities(const ContactProblem& problem, const Rows& rows) {
  Eigen::VectorXd v(rows.count);
  for (Slot s = 0; s < rows.first.size(); ++s) {
    if (rows.first[s] < 0) continue;
    v.segment<3>(rows.first[s]) = problem.free.linear[s];
    if (problem.rotates) v.segment<3>(rows.first[s] + 3) = problem.free.angular[s];
  }
  return v;
}

Eigen::VectorXd friction(const ContactProblem& problem) {
  return Eigen::Map<const Eigen::VectorXd>(problem.friction.data(), static_cast<Index>(problem.friction.size()));
}

}  // namespace

GlobalForm assemble_global(const ContactProblem& problem) {
  const Rows rows = rows_of(problem);
  GlobalForm form{mass_matrix(problem, rows, false), jacobian(problem, rows), {}, {}, friction(problem)};
  const Eigen::VectorXd v = free_velocities(problem, rows);
  form.f = form.M * v;
  form.w = -(form.H.transpose() * v);  // q - H^T v_free: offsets and driven bodies
  for (std::size_t i = 0; i < problem.size(); ++i)
    form.w.segment<3>(3 * static_cast<Index>(i)) += problem.free_relative_velocity(i);
  return form;
}

LocalForm assemble_local(const ContactProblem& problem) {
  const Rows rows = rows_of(problem);
  const Eigen::SparseMatrix<double> h = jacobian(problem, rows);
  LocalForm form{h.transpose() * mass_matrix(problem, rows, true) * h, {}, friction(problem)};
  form.q.resize(3 * static_cast<Index>(problem.size()));
  for (std::size_t i = 0; i < problem.size(); ++i)
    form.q.segment<3>(3 * static_cast<Index>(i)) = problem.free_relative_velocity(i);
  return form;
}

}  // namespace epafi
