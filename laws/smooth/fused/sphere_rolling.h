/// @file sphere_rolling.h  Dashpots beside friction springs and resistance to rolling of spheres: the pass of the law
/// between what it reads of the spheres and what comes of it.
#pragma once
#include "laws/smooth/fused/sphere_tile.h"
#include "laws/smooth/passes/tile_passes.h"

namespace epafi {

struct SphereRollingCall : RollingCall {
  SphereBlocks::Block& block;
  const SphereArrays& arrays;
  SphereSprings::Places at;
  bool wall, across;
};
void (*sphere_rolling())(const SphereRollingCall&);

}  // namespace epafi
