/// @file capsule_pairs.h  Closed forms for capsules and for a cylinder on a plane. R* uses the capsule's radius; along
/// its side the second, zero curvature is neglected.
#pragma once
#include "detection/narrow/pairs/pair_query.h"
#include "detection/shapes/capsule.h"
#include "detection/shapes/cylinder.h"
#include "detection/shapes/half_space.h"
#include "detection/shapes/sphere.h"

namespace epafi {

/// One point: the closest point of the axis.
void collide_closed(const Sphere& a, const Capsule& b, const PairQuery& q, ContactSink& sink);

/// One point at the closest points of the axes; two, at the ends of the common length, where the axes are parallel
/// within 1e-3 rad.
void collide_closed(const Capsule& a, const Capsule& b, const PairQuery& q, ContactSink& sink);

/// One point per end within reach.
void collide_closed(const Capsule& a, const HalfSpace& b, const PairQuery& q, ContactSink& sink);

/// Deepest point of the lower rim, three points of that rim fixed in the body (feet when it stands), deepest point of
/// the other rim (when it lies); those within reach.
void collide_closed(const Cylinder& a, const HalfSpace& b, const PairQuery& q, ContactSink& sink);

}  // namespace epafi
