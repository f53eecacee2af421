/// @file nsgs.cpp  Block Gauss-Seidel with the exact 3 x 3 local solution, coloured and parallel.
#include "laws/nonsmooth/solvers/nsgs.h"

#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/gauss_seidel.h"

namespace epafi {

SolverEntry nsgs_entry() {
  Entry entry{"nsgs", "block Gauss-Seidel with the exact local solution of every contact", solver_fields(),
              solver_needs, "Jean 1999; Bonnefon and Daviet 2011"};
  return {std::move(entry), [](const Parameters& parameters) -> std::unique_ptr<ContactSolver> {
            return std::make_unique<GaussSeidel<NsgsRule>>(NsgsRule{}, parameters);
          }};
}

}  // namespace epafi
