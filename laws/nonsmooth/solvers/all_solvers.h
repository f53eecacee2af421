/// @file all_solvers.h  The list of non-smooth solvers: declare the entry, add the name. One file per solver.
#pragma once
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

SolverEntry pgs_entry();
SolverEntry nsgs_entry();
SolverEntry newton_entry();
SolverEntry proximal_entry();
SolverEntry auto_entry();

inline const std::vector<SolverEntry>& all_solvers() {
  static const std::vector<SolverEntry> list{
      pgs_entry(),
      nsgs_entry(),
      newton_entry(),
      proximal_entry(),
      auto_entry(),
  };
  return list;
}

}  // namespace epafi
