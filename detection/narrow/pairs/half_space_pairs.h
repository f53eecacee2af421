/// @file half_space_pairs.h  Closed forms against a plane: the points of the body below (or within reach of) it.
#pragma once
#include "detection/narrow/pairs/convex_pairs.h"
#include "detection/narrow/pairs/hertz_radius.h"
#include "detection/narrow/pairs/resting_side.h"
#include "detection/narrow/polyhedra/manifold.h"
#include "detection/shapes/half_space.h"

namespace epafi {

/// Vertices within reach, reduced by keep_corners, named by their index.
void collide_with_plane(const PolyhedronView& a, double sweep, double radius, const HalfSpace& b, const PairQuery& q,
                        ContactSink& sink);

template <PolyhedralShape S>
void collide_closed(const S& a, const HalfSpace& b, const PairQuery& q, ContactSink& sink) {
  collide_with_plane(a.view(), a.rounding(), contact_radius(a), b, q, sink);
}

/// Any other convex body: its deepest point. A body with a flat side or a straight edge gives a better-fitting
/// overload.
template <ConvexShape S>
requires(!PolyhedralShape<S>) void collide_closed(const S& a, const HalfSpace& b, const PairQuery& q,
                                                  ContactSink& sink) {
  const Vec3 outward = q.b.orientation * b.normal;
  const Vec3 towards = q.a.orientation.conjugate() * -outward;
  const Vec3 deepest = q.a.orientation * a.support(towards);
  const double gap = outward.dot(q.a.position - q.b.position) + outward.dot(deepest) - a.rounding();
  if (!(gap < q.reach)) return;
  double radius = contact_radius(a);
  if constexpr (RoundShape<S>)
    if (q.curvature) radius = hertz_radius_on_plane(RoundRef::to(a), a.rounding(), towards);
  const Vec3 point = deepest - (a.rounding() + 0.5 * gap) * outward;
  if constexpr (RestsFlat<S>)
    if (q.reach > 0.0)
      return rest_on_plane(leaning_side(&a, resting_side_of<S>, towards), {point, -outward, gap},
                           outward.dot(q.a.position - q.b.position), a.bounding_radius(), radius, q, sink);
  sink.add({gap, -outward, point, radius, 0});
}

}  // namespace epafi
