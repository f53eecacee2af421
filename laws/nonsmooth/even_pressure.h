/// @file even_pressure.h  Distribution of the load of servo walls over their contacts. A wall does not rotate, so every
/// centre of pressure solves the problem of the step if the opposite wall has the same one; sweeps put all load on the
/// contact they visit first. The distribution matters when the wall slides: friction at one edge of both pads of a
/// gripper would tilt the body. Here impulses are those of elastic faces of equal stiffness: r_N = G x for small
/// displacements x of the bodies, with given G^T r_N. This is the shortest r_N with the same effect on the bodies.
#pragma once
#include <cstdint>
#include <vector>

#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

class EvenPressure {
 public:
  /// Distributes the load of closed contacts at servo walls. u = W r + q. Returns true if r has changed by more than 1
  /// %: friction then needs a new solution; else r is unchanged.
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
