/// @file even_pressure.h  How servo walls press on what lies between them. A wall does not turn, so the impulses of its
/// points may lie anywhere on the face it presses: every centre of pressure solves the problem of the step as long as
/// the opposite wall has the same. It counts as soon as the wall slides: friction at one edge of both pads of a gripper
/// tilts the body that slips through them. Sweeps leave all the load at the point they come to first.
/// Elastic faces of equal stiffness share the load: the impulses are those of small displacements x of the bodies,
/// r_N = G x, G^T r_N given, which is the shortest r_N that moves the bodies alike.
#pragma once
#include <cstdint>
#include <vector>

#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

class EvenPressure {
 public:
  /// Shares the load of closed contacts beside servo walls out evenly. u = W r + q. True: r has changed by more than a
  /// hundredth and no longer solves the problem where friction depends on it; else r is as it was.
  bool apply(const ContactProblem& problem, const std::vector<Vec3>& u, double touching, Impulses& r);

 private:
  using Vector = Eigen::VectorXd;
  using Matrix = Eigen::MatrixXd;

  void collect(const ContactProblem& problem, const std::vector<Vec3>& u, double touching, const Impulses& r);
  void reach(const ContactProblem& problem, const std::vector<Vec3>& u, double touching, const Impulses& r);
  Matrix displacements(const ContactProblem& problem) const;
  void share_friction(const ContactProblem& problem, const Vector& normal, Impulses& r) const;

  std::vector<Slot> bodies_;  ///< walls and free bodies near them
  std::vector<int> column_;   ///< of a body in G, by slot; < 0: none
  int columns_ = 0;           ///< 1 for a wall, 6 for a free body
  std::vector<std::uint32_t> contacts_;
};

}  // namespace epafi
