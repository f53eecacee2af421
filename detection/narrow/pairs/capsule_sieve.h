/// @file capsule_sieve.h  Which pairs of capsules of a run may touch: two, four or eight at a time, by the distance of
/// their axes. A list of elongated bodies names many pairs that are apart (of 2000 settled capsules five of six); the
/// closed form, one pair at a time, is evaluated for the others only.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "detection/shapes/capsule.h"
#include "engine/state/contacts.h"

namespace epafi {

/// Places in `pairs` of those whose gap may be below `reach` [m], ascending: all for which collide_closed gives
/// contacts, and hardly any other. It lasts until the next call on the same thread.
std::span<const std::uint32_t> near_capsules(const World& world, std::span<const Capsule> shapes,
                                             std::span<const Pair> pairs, double reach);

}  // namespace epafi
