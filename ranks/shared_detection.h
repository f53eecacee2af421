/// @file shared_detection.h  Detection stages of rank 0 that use all ranks (detection_part.h); for the rest of the
/// simulation they are those of one process.
#pragma once
#include <memory>

#include "engine/ranks/rank_team.h"
#include "engine/step/simulation.h"

namespace epafi {

/// By rank 0, while the others obey. busy: true within something that all ranks do together. Returns who tells what it
/// has come to, while the simulation lives.
std::function<RankFigures()> share_detection(Simulation& whole, std::shared_ptr<Simulation> part, PartSetup setup,
                                             bool& busy);

}  // namespace epafi
