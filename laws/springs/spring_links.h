/// @file spring_links.h  What the springs of a scene resist at this moment, for engine/step/stiffest_mode.h.
#pragma once
#include "engine/step/stiffest_mode.h"
#include "laws/springs/spring_forces.h"

namespace epafi {

/// Three links a spring, along the axes of its far end; those of a frame on a way count as the world's axes. dt [s].
void append_spring_links(const std::vector<SpringElement>& springs, const World& world, double dt,
                         std::vector<StiffLink>& links);

}  // namespace epafi
