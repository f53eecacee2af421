/// @file cone_problem.h  A friction-contact problem as 3 x 3 and 6 x 3 blocks, for solvers that factor and for problem
/// files: u = W r + q, K*_mu contains u~, orthogonal to r in K_mu. Two forms:
///   body form   W = H^T M^-1 H with M block-diagonal (6 velocities per body) and at most two bodies per contact
///   local form  W itself in 3 x 3 blocks, when nothing is known about bodies
/// Memory is linear in contacts (body form) or in the blocks of W. Bodies that cannot move have no rows.
#pragma once
#include <array>
#include <span>

#include "laws/nonsmooth/assembled.h"
#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using Mat63 = Eigen::Matrix<double, 6, 3>;

struct ConeProblem {
  static constexpr std::uint32_t no_body = 0xffffffffu;

  std::vector<double> friction;  ///< mu >= 0
  std::vector<Vec3> q;           ///< free relative velocity, normal first [m/s]
  std::vector<Mat3> diagonal;    ///< W_ii [1/kg]; 0 where no impulse moves anything
  double scale = 1.0;            ///< rho of the residual [kg]: 1 for problem files, 1/mean(W_NN) in a run
  double reference = 0.0;  ///< of the residual, in place of ||q|| [m/s]; 0: ||q|| (islands share that of the whole)

  /// One contact of the body form.
  struct Row {
    std::array<std::uint32_t, 2> body{no_body, no_body};  ///< no_body: one that cannot move
    std::array<Mat63, 2> jacobian;                        ///< H, rows of the body
    std::array<Mat63, 2> response;                        ///< M^-1 H
  };
  std::vector<Row> rows;   ///< body form; empty in the local form
  std::vector<Mat6> mass;  ///< M, one block per body

  /// Local form: blocks of W by row of contacts; `begin` has one entry more than there are contacts.
  std::vector<std::size_t> begin;
  std::vector<std::uint32_t> column;
  std::vector<Mat3> block;

  std::size_t size() const { return friction.size(); }
  std::size_t bodies() const { return mass.size(); }
  bool has_bodies() const { return !mass.empty(); }
  bool moves(std::size_t i) const { return diagonal[i](0, 0) > 0.0; }

  /// u = W r + q; `v` is room for the body form.
  void relative_velocities(const Impulses& r, std::vector<Vec6>& v, std::vector<Vec3>& u) const;
  /// M^-1 H r; body form only.
  void body_velocities(const Impulses& r, std::vector<Vec6>& v) const;
  /// u_i - q_i of body velocities; body form only.
  Vec3 relative(std::size_t i, const std::vector<Vec6>& v) const {
    const Row& row = rows[i];
    Vec3 u = Vec3::Zero();
    for (std::size_t s = 0; s < 2; ++s)
      if (row.body[s] != no_body) u.noalias() += row.jacobian[s].transpose() * v[row.body[s]];
    return u;
  }
  /// Reference of the residual: `reference`, or the Euclidean norm of q, or 1 if that is 0.
  double q_norm() const;
  /// Residual of impulses r with their velocities u (laws/nonsmooth/residual.h) for rho = scale, over contacts with
  /// W_ii > 0.
  double residual(const Impulses& r, const std::vector<Vec3>& u) const;

  /// Loads the problem of a step; reuses memory from call to call.
  void load(const ContactProblem& problem);
  /// Converts matrices. The global form becomes the body form if M has blocks of at most six velocities and every
  /// contact touches at most two of them, else W is computed.
  static ConeProblem from(const GlobalForm& form);
  static ConeProblem from(const LocalForm& form);
  /// The normal rows alone as a dense matrix, for solvers of linear complementarity problems.
  Eigen::MatrixXd normal_matrix() const;
  /// W as a dense matrix: 3 x 3 blocks in contact order.
  Eigen::MatrixXd dense() const;

 private:
  std::vector<std::uint32_t> body_of_;  ///< by slot
};

}  // namespace epafi
