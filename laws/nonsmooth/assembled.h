/// @file assembled.h  A contact problem as matrices, in FCLIB's two forms, for solvers that factor or read files.
///   global: M v = H r + f, u = H^T v + w;   local: u = W r + q with W = H^T M^-1 H, q = H^T M^-1 f + w
/// Columns of H: three per contact, in contact order. Rows of M and H: the free bodies by slot, 3 each or 6 with
/// rotation. The velocities of driven bodies stand in w.
#pragma once
#include <Eigen/SparseCore>

#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

struct GlobalForm {
  Eigen::SparseMatrix<double> M, H;
  Eigen::VectorXd f, w, mu;
};
[[nodiscard]] GlobalForm assemble_global(const ContactProblem& problem);

struct LocalForm {
  Eigen::SparseMatrix<double> W;
  Eigen::VectorXd q, mu;
};
[[nodiscard]] LocalForm assemble_local(const ContactProblem& problem);

}  // namespace epafi
