/// @file ball_parts.h  Two clumps of balls: selects the pairs of balls to test. Centres are computed once per pair,
/// those of the first body once for all its successive pairs; only balls that reach into the other clump's box are
/// tested.
#pragma once
#include "detection/narrow/pairs/pair_query.h"
#include "detection/shapes/clump.h"

namespace epafi {

/// Contacts of every ball of A with every ball of B, by the closed form of two spheres.
void collide_balls(const Clump& a, const Clump& b, const PairQuery& q, ContactSink& sink);

}  // namespace epafi
