/// @file resting_side.h  Flat ends of bodies whose surface is smooth but hardly curved there, for rigid laws. With the
/// deepest point alone a superquadric of large exponents rocks for ever: a tilt of 1e-9 moves that point by a tenth of
/// its size, and the force of each step overturns the last one.
#pragma once
#include "detection/narrow/pairs/core_patch.h"
#include "detection/narrow/pairs/pair_query.h"
#include "detection/shapes/superquadric.h"

namespace epafi {

/// Four points at the top of the end that lies across d, where the surface is 5e-8 of the size below (half of what
/// counts as equally deep in manifold.cpp); of a round section two, on the line along z. Exponents from 4 on.
FlatSide resting_side(const Superquadric& s, const Vec3& d);

template <class S>
concept RestsFlat = requires(const S& s, const Vec3& d) {
  { resting_side(s, d) } -> std::same_as<FlatSide>;
};
template <RestsFlat S>
FlatSide resting_side_of(const void* shape, const Vec3& d) {
  return resting_side(*static_cast<const S*>(shape), d);
}

/// Contacts of these corners with a plane, beside the nearest point; both from A's centre in world axes. height: of the
/// centre above the plane [m]; size: of A.
void rest_on_plane(const FlatSide& side, const NearestPoint& nearest, double height, double size, double radius,
                   const PairQuery& q, ContactSink& sink);

}  // namespace epafi
