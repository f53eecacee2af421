/// @file residual.h  The one error measure of all solvers, taken outside them.
///   residual = ||r - P_K(r - rho u~)|| / (rho ||q||), Euclidean over all contacts
/// (De Saxce natural map; Acary, Bremond and Huber 2018 with rho = 1, which depends on units; in a run rho =
/// 1/mean(W_ii normal) does not). A per-contact maximum alone misleads on stacks, where the error is smooth along the
/// stack.
#pragma once
#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

struct Residual {
  double value = 0.0;             ///< [-]; the plain norm over rho where q = 0
  double penetration_rate = 0.0;  ///< max(-u_N) / max|q| [-]: 0.01 on a stack sinks with 1 % of g
};

/// Reference velocities of the residual.
struct FreeMotion {
  double norm = 1.0;     ///< ||q|| [m/s], 1 where q = 0; of contacts that impulses move, as the next one
  double largest = 1.0;  ///< max|q| [m/s], 1 where q = 0
};
[[nodiscard]] FreeMotion measure_free_motion(const ContactProblem& problem);

/// Residual of impulses r with the velocities u = W r + q that result from them; rho > 0 [kg].
[[nodiscard]] Residual measure_residual(const ContactProblem& problem, const Impulses& r, const std::vector<Vec3>& u,
                                        double rho, const FreeMotion& q);

/// The same; computes the velocities of the bodies and of the contacts on the way and leaves them in v and u.
[[nodiscard]] Residual measure_residual(const ContactProblem& problem, const Impulses& r, double rho, BodyVelocities& v,
                                        std::vector<Vec3>& u);

}  // namespace epafi
