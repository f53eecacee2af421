#include "laws/nonsmooth/cone_problem.h"

#include <algorithm>

#include "engine/threads/order_free_sum.h"
#include "engine/units/error.h"
#include "laws/factors.h"
#include "laws/nonsmooth/cone.h"

namespace epafi {

void ConeProblem::body_velocities(const Impulses& r, std::vector<Vec6>& v) const {
  v.assign(mass.size(), Vec6::Zero());
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t s = 0; s < 2; ++s)
      if (rows[i].body[s] != no_body) v[rows[i].body[s]].noalias() += rows[i].response[s] * r[i];
}

void ConeProblem::relative_velocities(const Impulses& r, std::vector<Vec6>& v, std::vector<Vec3>& u) const {
  u.resize(size());
  if (has_bodies()) {
    body_velocities(r, v);
    for (std::size_t i = 0; i < size(); ++i) u[i] = q[i] + relative(i, v);
    return;
  }
  for (std::size_t i = 0; i < size(); ++i) {
    u[i] = q[i];
    if (begin.empty()) continue;
    for (std::size_t k = begin[i]; k < begin[i + 1]; ++k) u[i].noalias() += block[k] * r[column[k]];
  }
}

double ConeProblem::q_norm() const {
  if (reference > 0.0) return reference;
  const double sum = order_free_sum(q.size(), [&](std::size_t i) { return q[i].squaredNorm(); });
  return sum > 0.0 ? std::sqrt(sum) : 1.0;
}

double ConeProblem::residual(const Impulses& r, const std::vector<Vec3>& u) const {
  const double sum = order_free_sum(size(), [&](std::size_t i) {
    return moves(i) ? natural_map(r[i], u[i], friction[i], scale).squaredNorm() : 0.0;
  });
  return std::sqrt(sum) / (scale * q_norm());
}

void ConeProblem::load(const ContactProblem& p) {
  EPAFI_REQUIRE(p.diagonal.size() == p.size(), "the blocks W_ii are loaded before a solver reads them");
  reference = 0.0;
  friction.assign(p.friction.begin(), p.friction.end());
  diagonal = p.diagonal;
  q.resize(p.size());
  rows.resize(p.size());
  body_of_.assign(p.inverse_mass.size(), no_body);
  mass.clear();
  for (Slot s = 0; s < p.inverse_mass.size(); ++s) {
    if (!p.is_free(s) || p.incidence.count(s) == 0) continue;
    body_of_[s] = static_cast<std::uint32_t>(mass.size());
    Mat6 m = Mat6::Identity();
    m.topLeftCorner<3, 3>() *= 1.0 / p.inverse_mass[s];
    if (p.rotates) m.bottomRightCorner<3, 3>() = p.inverse_inertia[s].inverse();
    mass.push_back(m);
  }
  parallel_for(p.size(), [&](std::size_t i) {
    q[i] = p.free_relative_velocity(i);
    Row& row = rows[i];
    Mat3 axes;
    axes << p.frame[i].normal, p.frame[i].tangent1, p.frame[i].tangent2;
    for (std::size_t s = 0; s < 2; ++s) {
      const Slot slot = s == 0 ? p.a[i] : p.b[i];
      const double sign = s == 0 ? -1.0 : 1.0;
      row.body[s] = body_of_[slot];
      row.jacobian[s].setZero();
      row.response[s].setZero();
      if (row.body[s] == no_body) continue;
      row.jacobian[s].topRows<3>() = sign * axes;
      row.response[s].topRows<3>() = (sign * p.inverse_mass[slot]) * axes;
      if (!p.rotates) continue;
      const Vec3& arm = s == 0 ? p.arm_a[i] : p.arm_b[i];
      for (int k = 0; k < 3; ++k) row.jacobian[s].col(k).tail<3>() = sign * arm.cross(axes.col(k));
      row.response[s].bottomRows<3>() = p.inverse_inertia[slot] * row.jacobian[s].bottomRows<3>();
    }
  });
  scale = p.mean_effective_mass();
}

Eigen::MatrixXd ConeProblem::dense() const {
  const auto n = static_cast<Eigen::Index>(size());
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  if (has_bodies()) {
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(6 * static_cast<Eigen::Index>(bodies()), 3 * n), y = h;
    for (Eigen::Index i = 0; i < n; ++i)
      for (std::size_t s = 0; s < 2; ++s) {
        const Row& row = rows[static_cast<std::size_t>(i)];
        if (row.body[s] == no_body) continue;
        h.block<6, 3>(6 * static_cast<Eigen::Index>(row.body[s]), 3 * i) += row.jacobian[s];
        y.block<6, 3>(6 * static_cast<Eigen::Index>(row.body[s]), 3 * i) += row.response[s];
      }
    return transposed_product(h, y);
  }
  for (std::size_t i = 0; i + 1 < begin.size(); ++i)
    for (std::size_t k = begin[i]; k < begin[i + 1]; ++k)
      w.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(column[k])) = block[k];
  return w;
}

Eigen::MatrixXd ConeProblem::normal_matrix() const {
  const Eigen::MatrixXd w = dense();
  const auto every_third = Eigen::seqN(0, static_cast<Eigen::Index>(size()), 3);
  return w(every_third, every_third);
}

}  // namespace epafi
