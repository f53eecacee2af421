/// @file convex_pairs.h  Convex pairs without a closed form: polyhedra by their features, round shapes by their common
/// normal, everything else by GJK and EPA.
#pragma once
#include "detection/narrow/common_normal.h"
#include "detection/narrow/core_patch.h"
#include "detection/narrow/manifold.h"
#include "detection/narrow/minkowski.h"
#include "detection/narrow/pair_query.h"

namespace epafi {

/// Two cores with the spheres swept over them, and the radii that stand for their curvature [m].
struct RoundedPair {
  double sweep_a, sweep_b, radius_a, radius_b;
};

/// Distance by GJK while the cores are apart, depth by EPA otherwise: one point.
void collide_cores(const ConvexRef& a, const ConvexRef& b, const RoundedPair& rounded, const PairQuery& q,
                   ContactSink& sink);

/// The same where both are round: by their common normal, by the former where that is not certain.
void collide_round(const RoundRef& a, const RoundRef& b, const ConvexRef& core_a, const ConvexRef& core_b,
                   const RoundedPair& rounded, const PairQuery& q, ContactSink& sink);

/// The same where one is a polyhedron and the other has flat sides: up to 4 points. `sides`: of the core, as in
/// CoreAndPolyhedron.
struct FlatCore {
  const PolyhedronView& polyhedron;
  const void* shape;
  FlatSide (*facing)(const void* shape, const Vec3& d);
  bool polyhedron_first;  ///< it is A
};
void collide_flat_core(const ConvexRef& a, const ConvexRef& b, const FlatCore& sides, const RoundedPair& rounded,
                       const PairQuery& q, ContactSink& sink);

/// The same where neither is a polyhedron and both have flat sides.
struct FlatSides {
  FlatSide (*facing_a)(const void* shape, const Vec3& d);
  FlatSide (*facing_b)(const void* shape, const Vec3& d);
};
void collide_flat_pair(const ConvexRef& a, const ConvexRef& b, const FlatSides& sides, const RoundedPair& rounded,
                       const PairQuery& q, ContactSink& sink);

template <HasFlatSides S>
FlatSide facing_of(const void* shape, const Vec3& d) {
  return static_cast<const S*>(shape)->facing(d);
}

/// Signed distance by features, up to 4 points by clipping.
void collide_polyhedra(const PolyhedronView& a, const PolyhedronView& b, const RoundedPair& rounded, const PairQuery& q,
                       ContactSink& sink);

template <class A, class B>
RoundedPair rounded_pair(const A& a, const B& b) {
  return {a.rounding(), b.rounding(), contact_radius(a), contact_radius(b)};
}

/// The default for two convex shapes. A closed form (collide_closed) replaces it.
template <ConvexShape A, ConvexShape B>
void collide(const A& a, const B& b, const PairQuery& q, ContactSink& sink) {
  if constexpr (PolyhedralShape<A> && PolyhedralShape<B>) {
    collide_polyhedra(a.view(), b.view(), rounded_pair(a, b), q, sink);
  } else if constexpr (PolyhedralShape<A> && HasFlatSides<B>) {
    collide_flat_core(ConvexRef::to(a), ConvexRef::to(b), {a.view(), &b, facing_of<B>, true}, rounded_pair(a, b), q,
                      sink);
  } else if constexpr (HasFlatSides<A> && PolyhedralShape<B>) {
    collide_flat_core(ConvexRef::to(a), ConvexRef::to(b), {b.view(), &a, facing_of<A>, false}, rounded_pair(a, b), q,
                      sink);
  } else if constexpr (HasFlatSides<A> && HasFlatSides<B>) {
    collide_flat_pair(ConvexRef::to(a), ConvexRef::to(b), {facing_of<A>, facing_of<B>}, rounded_pair(a, b), q, sink);
  } else if constexpr (RoundShape<A> && RoundShape<B>) {
    collide_round(RoundRef::to(a), RoundRef::to(b), ConvexRef::to(a), ConvexRef::to(b), rounded_pair(a, b), q, sink);
  } else {
    collide_cores(ConvexRef::to(a), ConvexRef::to(b), rounded_pair(a, b), q, sink);
  }
}

}  // namespace epafi
