/// @file part_figures.h  What sharing out has come to, of this rank and of all.
#pragma once
#include "engine/ranks/remote_steps.h"

namespace epafi {

struct PartFigures {
  double own = 0.0, ghosts = 0.0;  ///< bodies, summed over the steps
  double steps = 0.0;
  double moved = 0.0;  ///< how often bodies went to other ranks
  double bytes = 0.0;  ///< sent in all
};

/// By all ranks.
RankFigures gather_figures(const PartFigures& mine);

}  // namespace epafi
