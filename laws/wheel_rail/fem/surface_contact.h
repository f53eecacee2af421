/// @file surface_contact.h  Unilateral contact on a flexibility matrix by Lagrange multipliers, penalty or augmented
/// Lagrangian (Wriggers 2006, chapter 5; Simo and Laursen 1992), at nodes or integrated over the surface.
#pragma once
#include <Eigen/Core>

#include "engine/step/report.h"
#include "laws/wheel_rail/half_space/normal.h"

namespace epafi {

enum class Enforcement { lagrange, penalty, augmented_lagrangian };

/// gap_i + (W p)_i - approach >= 0, p >= 0, complementary; sum weight_i p_i is the force. At nodes p are forces and
/// weight is 1; over the surface p are nodal pressures, gap and W are integrated with the shape functions, weight is
/// int phi_i.
struct SurfaceProblem {
  Eigen::MatrixXd W;
  Eigen::VectorXd gap, level, weight;  ///< level: what the approach is multiplied with in each row (1, or int phi_i)
};

struct SurfaceContact {
  Eigen::VectorXd p;
  double approach = 0.0, force = 0.0;
  double penetration = 0.0;  ///< largest remaining (penalty: p over its stiffness) [m]
  SolverReport report;       ///< residual: force against load, relative
};

/// `penalty`: stiffness per unit of p's weight, such that p = penalty * penetration [N/m at nodes, Pa/m over the
/// surface].
SurfaceContact solve_surface_contact(const SurfaceProblem& problem, const NormalTarget& target, Enforcement method,
                                     double penalty);

}  // namespace epafi
