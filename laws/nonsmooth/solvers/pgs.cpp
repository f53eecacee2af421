/// @file pgs.cpp  Projected Gauss-Seidel with warm start, coloured and parallel.
#include "laws/nonsmooth/solvers/pgs.h"

#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/gauss_seidel.h"
#include "laws/nonsmooth/solvers/pyramid.h"

namespace epafi {

SolverEntry pgs_entry() {
  Entry entry{"pgs", "projected Gauss-Seidel: normal row, then the tangential rows on the exact Coulomb disk",
              solver_fields({{"relaxation", "omega", "", Kind::number, 1.0, {0, 2, true, true}, "relaxation factor"},
                             cone_field("pyramid", "a regular polygon of `sides` corners inside the disk"),
                             {"sides", "m", "", Kind::integer, 4.0, {3, 64}, "number of sides of the pyramid"}}),
              solver_needs, "Jourdan, Alart and Jean 1998"};
  return {std::move(entry), [](const Parameters& parameters) -> std::unique_ptr<ContactSolver> {
            const double relaxation = parameters.number_or("relaxation", 1.0);
            if (!parameters.has("cone") || parameters.text("cone") != "pyramid")
              return std::make_unique<GaussSeidel<PgsRule>>(PgsRule{relaxation}, parameters);
            const int sides = static_cast<int>(parameters.number_or("sides", 4));
            return std::make_unique<GaussSeidel<PyramidRule>>(PyramidRule(relaxation, sides), parameters);
          }};
}

}  // namespace epafi
