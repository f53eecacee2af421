/// @file hollow_pairs.h  Contacts with hollow walls of no thickness (tube, cone), in closed form for balls.
/// Balls: every local minimum of the distance along the wall's outline in the half plane of axis and centre, on the
/// near side and, from inside, on the far side too (a ball that is wider than the wall). So a ball touches the side, a
/// closed end, both in the corner between them, and the rim of an open end. Other convex bodies touch the side of the
/// wall on which their centre is:
/// * inside, contacts are at the corners of polyhedra and capsules, and at the extreme points of other bodies (exact,
///   since the inside is convex); a closed end is a plane;
/// * outside, the wall is the solid that it encloses;
/// * the rim of an open end is searched for its deepest points, from 24 directions, with the normal perpendicular to
/// the
///   rim and to the body's surface or edge.
/// At most four points a part. Limits: a body whose centre crosses the wall changes sides; of contacts within 15
/// degrees around the axis one is found; a tilted body wider than a short tube touches only its rims. The radius R* has
/// the curvature of the wall across it, negative inside: an elliptic contact (hertz_radius.h). On a rim the curvature
/// varies from that of the inside to that of the outside. The wall's curvature is limited to 0.9 of the body's; beyond,
/// the contact is no point contact (a ball wedged in a cone touches along a circle).
#pragma once
#include "detection/narrow/pairs/capsule_pairs.h"
#include "detection/narrow/pairs/convex_pairs.h"
#include "detection/narrow/pairs/half_space_pairs.h"
#include "detection/narrow/pairs/hertz_radius.h"
#include "detection/narrow/pairs/sphere_pairs.h"
#include "detection/shapes/capsule.h"
#include "detection/shapes/cone.h"
#include "detection/shapes/tube.h"

namespace epafi {

/// A ball in the wall's axes: f(distance, direction, curvature, feature) for each place nearer than `limit`; direction:
/// unit, from the wall to the centre; features 0 near, 1 far, 2 start, 3 end.
struct WallTouch {
  double distance;   ///< of the centre [m], >= 0
  Vec3 direction;    ///< unit, from the wall towards the centre, wall's axes
  double curvature;  ///< of the wall across, negative inside [1/m]
  Feature feature;
};
struct WallTouches {
  std::array<WallTouch, 4> touch;
  int count = 0;
  void add(const WallTouch& t) { touch[static_cast<std::size_t>(count++)] = t; }
};
WallTouches ball_touches(const HollowWall& wall, const Vec3& centre, double limit);

void collide_ball(double radius, const HollowWall& wall, const PairQuery& q, ContactSink& sink);

/// A convex body behind pointers.
struct HollowGuest {
  const void* shape;
  ConvexRef core;
  double sweep, contact_radius;
  std::span<const Vec3> corners;                 ///< extreme points of the core, body axes; empty: use the support
  FlatSide (*facing)(const void*, const Vec3&);  ///< or null
  const RoundRef* round;                         ///< or null
  void (*on_plane)(const void*, const HalfSpace&, const PairQuery&, ContactSink&);
  void (*on_solid)(const void*, const HollowSolid&, const PairQuery&, ContactSink&);
  void (*on_point)(const void*, const PairQuery&, ContactSink&);  ///< A is a point
  bool one_point = false;                                         ///< of its corners the deepest alone touches the side
};
void collide_guest(const HollowGuest& guest, const HollowWall& wall, const PairQuery& q, ContactSink& sink);

template <HollowShape W>
void collide_closed(const Sphere& a, const W& b, const PairQuery& q, ContactSink& sink) {
  collide_ball(a.radius, b.wall, q, sink);
}

template <ConvexShape S, HollowShape W>
requires(!std::is_same_v<S, Sphere>) void collide_closed(const S& a, const W& b, const PairQuery& q,
                                                         ContactSink& sink) {
  HollowGuest guest{&a, ConvexRef::to(a), a.rounding(), contact_radius(a), {}, nullptr, nullptr, {}, {}, {}};
  std::array<Vec3, 2> ends;
  RoundRef round;
  if constexpr (PolyhedralShape<S>) {
    guest.corners = a.view().vertices;
  } else if constexpr (std::is_same_v<S, Capsule>) {
    ends = {Vec3(0.0, 0.0, -a.half_length()), Vec3(0.0, 0.0, a.half_length())};
    guest.corners = ends;
    guest.one_point = a.is_short();
  } else if constexpr (HasFlatSides<S>) {
    guest.facing = facing_of<S>;
  }
  if constexpr (RoundShape<S>) {
    round = RoundRef::to(a);
    guest.round = &round;
  }
  guest.on_plane = [](const void* s, const HalfSpace& plane, const PairQuery& p, ContactSink& out) {
    collide_closed(*static_cast<const S*>(s), plane, p, out);
  };
  guest.on_solid = [](const void* s, const HollowSolid& solid, const PairQuery& p, ContactSink& out) {
    collide(*static_cast<const S*>(s), solid, p, out);
  };
  guest.on_point = [](const void* s, const PairQuery& p, ContactSink& out) {
    const Sphere point{0.0};
    if constexpr (requires { collide_closed(point, *static_cast<const S*>(s), p, out); })
      collide_closed(point, *static_cast<const S*>(s), p, out);
    else
      collide(point, *static_cast<const S*>(s), p, out);
  };
  collide_guest(guest, b.wall, q, sink);
}

}  // namespace epafi
