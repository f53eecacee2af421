/// @file sphere_pairs.h  Closed forms for spheres: exact gap, normal and R*.
/// The contact point divides the line of centres in the ratio of the radii; on a flat wall it is on the sphere's
/// surface. A point in the middle of the overlap would shorten the arm by half the overlap: an error of 0.11 % of the
/// spin in case A08 (tolerance 0.1 %).
#pragma once
#include <cmath>

#include "detection/narrow/pairs/pair_query.h"
#include "detection/narrow/polyhedra/polyhedra.h"
#include "detection/shapes/box.h"
#include "detection/shapes/half_space.h"
#include "detection/shapes/sphere.h"

namespace epafi {

/// The normal of concentric spheres is arbitrary: z.
inline void collide_closed(const Sphere& a, const Sphere& b, const PairQuery& q, ContactSink& sink) {
  const Vec3 d = q.b.position - q.a.position;
  const double reach = a.radius + b.radius + q.reach, square = d.squaredNorm();
  if (!(square < reach * reach)) return;
  const double distance = std::sqrt(square);
  const double gap = distance - (a.radius + b.radius);
  if (!(gap < q.reach)) return;
  const Vec3 n = distance > 0.0 ? Vec3(d / distance) : Vec3(Vec3::UnitZ());
  const double share = a.radius / (a.radius + b.radius);  // of the line of centres
  sink.add({gap, n, share * distance * n, q.curvature ? effective_radius(a.radius, b.radius) : 0.0, 0});
}

inline void collide_closed(const Sphere& a, const HalfSpace& b, const PairQuery& q, ContactSink& sink) {
  const Vec3 outward = q.b.orientation * b.normal;
  const double gap = outward.dot(q.a.position - q.b.position) - a.radius;
  if (!(gap < q.reach)) return;
  sink.add({gap, -outward, -a.radius * outward, a.radius, 0});
}

/// Outside: closest point by clamping. Inside: the nearest face.
inline void collide_closed(const Sphere& a, const Box& b, const PairQuery& q, ContactSink& sink) {
  const Vec3 c = q.b.orientation.conjugate() * (q.a.position - q.b.position);  // sphere's centre in the box's axes
  const Vec3 outside = c - c.cwiseMax(-b.half).cwiseMin(b.half);
  const double square = outside.squaredNorm();
  double distance = 0.0;
  Vec3 outward = Vec3::Zero();  // from the box towards the centre, box axes
  if (square > 0.0) {
    const double reach = a.radius + q.reach;
    if (!(square < reach * reach)) return;
    distance = std::sqrt(square);
    outward = outside / distance;
  } else {
    int axis = 0;
    distance = -infinity;
    for (int k = 0; k < 3; ++k) {
      if (const double h = std::abs(c[k]) - b.half[k]; h > distance) {
        distance = h;
        axis = k;
      }
    }
    outward[axis] = c[axis] < 0.0 ? -1.0 : 1.0;
  }
  const double gap = distance - a.radius;
  if (!(gap < q.reach)) return;
  const Vec3 n = -(q.b.orientation * outward);
  sink.add({gap, n, a.radius * n, a.radius,
            0});  // flat, as a half-space; the same over edges, so that the force keeps a potential
}

/// Outside: GJK of the centre, a point. Inside: the nearest face plane.
void collide_closed(const Sphere& a, const ConvexHull& b, const PairQuery& q, ContactSink& sink);

}  // namespace epafi
