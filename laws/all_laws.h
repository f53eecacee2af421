/// @file all_laws.h  The lists of smooth law parts: include the header, add the name.
#pragma once
#include "laws/smooth/friction.h"
#include "laws/smooth/hertz.h"
#include "laws/smooth/hunt_crossley.h"
#include "laws/smooth/linear.h"
#include "laws/smooth/overlap_volume.h"
#include "laws/smooth/rolling.h"

namespace epafi {

template <class... L>
struct LawList {};

using NormalLaws = LawList<Linear, Hertz, HuntCrossley, OverlapVolume>;
using TangentialLaws = LawList<NoFriction, CoulombSpring, Mindlin>;
using RollingLaws = LawList<NoRolling, RollingSpring>;

}  // namespace epafi
