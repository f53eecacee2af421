/// @file pgs.cpp  Projected Gauss-Seidel with warm start, coloured and parallel.
#include "laws/nonsmooth/solvers/pgs.h"

#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/gauss_seidel.h"

namespace epafi {

SolverEntry pgs_entry() {
  Entry entry{"pgs",
              "projected Gauss-Seidel: normal row, then the tangential rows on the exact Coulomb disk",
              solver_fields({{"relaxation", "omega", "", Kind::number, 1.0, {0, 2, true, true}, "relaxation factor"}}),
              {.slip_velocity = true, .memory = true},
              "Jourdan, Alart and Jean 1998"};
  return {std::move(entry), [](const Parameters& parameters) -> std::unique_ptr<ContactSolver> {
            return std::make_unique<GaussSeidel<PgsRule>>(PgsRule{parameters.number_or("relaxation", 1.0)}, parameters);
          }};
}

}  // namespace epafi
