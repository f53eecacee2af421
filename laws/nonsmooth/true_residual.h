/// @file true_residual.h  The residual of impulses as they are, for files of problems: over all contacts, those that
/// nothing moves too, and in twice the digits of a double (Dekker 1971). Impulses that run off along a ray are so large
/// that W r + q in doubles loses q, and a residual of 0 comes out where nothing is solved.
#pragma once
#include "laws/nonsmooth/cone_problem.h"

namespace epafi {

struct TrueResidual {
  double value = 0.0;             ///< as ConeProblem::residual; NaN where impulses or velocities are no finite numbers
  double penetration_rate = 0.0;  ///< max(-u_N) / max|q|
};

[[nodiscard]] TrueResidual true_residual(const ConeProblem& problem, const Impulses& r);

}  // namespace epafi
