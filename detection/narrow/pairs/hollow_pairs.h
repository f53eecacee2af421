/// @file hollow_pairs.h  Contacts with hollow walls of no thickness (tube, cone), in closed form for balls.
/// Balls: every local minimum of the distance along the wall's outline in the half plane of axis and centre, on the
/// near side and, from inside, on the far side too (a ball that is wider than the wall). So a ball touches the side, a
/// closed end, both in the corner between them, and the rim of an open end. Other convex bodies feel the side of the
/// wall on which their centre is:
/// * inside the corners of polyhedra and capsules, and where other bodies reach furthest across the side, are held by
/// it
///   (exact: what is inside is convex, so that a convex body reaches furthest across at its extreme points); a closed
///   end is a plane;
/// * outside, the wall is the solid that it encloses;
/// * the rim of an open end is searched for its deepest points, from 24 directions, along with the normal that stands
///   across both the rim and the body's surface or edge.
/// At most four points a part. Limits: a body whose centre crosses the wall changes sides; of places that lie within
/// 15 degrees around the axis one is found, and a body that is wider than a short tube and tilted in it is held by its
/// rims alone.
/// The radius R* has the curvature of the wall across it, negative inside: an elliptic contact (hertz_radius.h). On a
/// rim the curvature goes over from that of the inside to that of the outside. A wall as curved as the body counts with
/// 0.9 of the body's curvature, where no law of a point contact holds (a ball wedged in a cone touches along a circle).
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

/// R* of a ball of radius r on a wall of that curvature across, negative inside [m].
double wall_contact_radius(double r, double curvature);

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
  std::span<const Vec3> corners;                 ///< extreme points of the core, body axes; empty: ask the support
  FlatSide (*facing)(const void*, const Vec3&);  ///< or null
  const RoundRef* round;                         ///< or null
  void (*on_plane)(const void*, const HalfSpace&, const PairQuery&, ContactSink&);
  void (*on_solid)(const void*, const HollowSolid&, const PairQuery&, ContactSink&);
  void (*on_point)(const void*, const PairQuery&, ContactSink&);  ///< A is a point
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
