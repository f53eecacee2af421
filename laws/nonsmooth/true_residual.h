/// @file true_residual.h  Residual of impulses for problem files: over all contacts, also those of fixed bodies, in
/// double-double arithmetic (Dekker 1971). In double precision, W r + q of diverged impulses loses q, and the residual
/// would wrongly be 0.
#pragma once
#include "laws/nonsmooth/cone_problem.h"

namespace epafi {

struct TrueResidual {
  double value = 0.0;             ///< as ConeProblem::residual; NaN if impulses or velocities are not finite
  double penetration_rate = 0.0;  ///< max(-u_N) / max|q|
};

[[nodiscard]] TrueResidual true_residual(const ConeProblem& problem, const Impulses& r);

}  // namespace epafi
