/// @file several_ranks.h  A run that several processes share, each with a part of the bodies (docs/clusters.md).
#pragma once
#include "engine/ranks/rank_team.h"
#include "scenes/assemble.h"

namespace epafi {

/// Throws a SceneError for everything in the scene that needs a single process, with lines and alternatives.
void check_shareable(const Assembly& assembly);

/// Data of the scene for the processes.
PartSetup part_setup(const Assembly& assembly);

/// Steps of the assembly by all processes from now on; part: the same scene assembled once more, its bodies apart.
void share_out(Assembly& whole, std::unique_ptr<Assembly> part, RankTeam& team);

}  // namespace epafi
