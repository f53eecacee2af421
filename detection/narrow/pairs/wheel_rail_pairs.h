/// @file wheel_rail_pairs.h  Rigid contact points of a wheelset on a track: every region where the vertical gap has a
/// minimum, normals from wheel to rail. Laws of rolling contact take whole regions instead (profiles/rolling_search.h).
#pragma once
#include "detection/narrow/pairs/pair_query.h"
#include "detection/shapes/rail_profile.h"
#include "detection/shapes/wheel_profile.h"

namespace epafi {

void collide_closed(const WheelProfile& a, const RailProfile& b, const PairQuery& q, ContactSink& sink);

}  // namespace epafi
