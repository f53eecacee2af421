/// @file all_solvers.h  The list of non-smooth solvers: declare the entry, add the name. One file per solver.
#pragma once
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

SolverEntry pgs_entry();
SolverEntry nsgs_entry();
SolverEntry newton_entry();
SolverEntry proximal_entry();
SolverEntry auto_entry();
SolverEntry adaptive_entry();
SolverEntry lagrange_entry();
SolverEntry penalty_entry();
SolverEntry augmented_lagrangian_entry();
SolverEntry admm_entry();
SolverEntry apgd_entry();
SolverEntry projected_gradient_entry();
SolverEntry avbd_entry();
SolverEntry lemke_entry();
SolverEntry dantzig_entry();
SolverEntry conjugate_projected_gradient_entry();
SolverEntry newton_min_entry();
SolverEntry fischer_burmeister_entry();
SolverEntry soft_step_entry();

inline const std::vector<SolverEntry>& all_solvers() {
  static const std::vector<SolverEntry> list{
      pgs_entry(),
      nsgs_entry(),
      newton_entry(),
      proximal_entry(),
      auto_entry(),
      adaptive_entry(),
      lagrange_entry(),
      penalty_entry(),
      augmented_lagrangian_entry(),
      admm_entry(),
      apgd_entry(),
      projected_gradient_entry(),
      avbd_entry(),
      lemke_entry(),
      dantzig_entry(),
      conjugate_projected_gradient_entry(),
      newton_min_entry(),
      fischer_burmeister_entry(),
      soft_step_entry(),
  };
  return list;
}

}  // namespace epafi
