/// @file convex_pairs.h  Convex pairs without a closed form: polyhedra by their features, round shapes and cylinders by
/// their common normal, everything else by GJK and EPA.
#pragma once
#include "detection/narrow/gjk/common_normal.h"
#include "detection/narrow/gjk/cylinder_distance.h"
#include "detection/narrow/gjk/minkowski.h"
#include "detection/narrow/pairs/core_patch.h"
#include "detection/narrow/pairs/pair_query.h"
#include "detection/narrow/pairs/pair_radius.h"
#include "detection/narrow/pairs/resting_side.h"
#include "detection/narrow/polyhedra/manifold.h"

namespace epafi {

/// Two cores with their swept spheres [m], and the radii for R*.
struct RoundedPair {
  double sweep_a, sweep_b;
  TouchingRadius radius_a, radius_b;
};

/// Signed distance of two cores by a fast method for their kinds; if `uncertain`, use GJK and EPA. rotation, offset:
/// B's axes and centre in A's.
using QuickDistance = CommonNormal (*)(const void* a, const void* b, const Mat3& rotation, const Vec3& offset,
                                       double limit);

/// Null where there is none.
template <class A, class B>
constexpr QuickDistance quick_distance() {
  if constexpr (RoundShape<A> && RoundShape<B>) {
    return [](const void* a, const void* b, const Mat3& rotation, const Vec3& offset, double limit) {
      return common_normal(RoundRef::to(*static_cast<const A*>(a)), RoundRef::to(*static_cast<const B*>(b)), rotation,
                           offset, limit);
    };
  } else if constexpr (CylinderShape<A> && CylinderShape<B>) {
    return [](const void* a, const void* b, const Mat3& rotation, const Vec3& offset, double limit) {
      return cylinder_distance(static_cast<const A*>(a)->cylinder_core(), static_cast<const B*>(b)->cylinder_core(),
                               rotation, offset, limit);
    };
  } else {
    return nullptr;
  }
}

/// A core eroded by a ball (the same core less a sweep of the ball's radius). A ball of the least radius of curvature
/// rolls freely inside a smooth convex body (Blaschke 1956).
struct PeeledCore {
  ConvexRef inner;
  double peel = 0.0;  ///< radius of the ball [m]; 0: no erosion (the core has corners)

  template <ConvexShape S>
  static PeeledCore of(const S& s) {
    if constexpr (RoundShape<S>) {
      const auto support = [](const void* p, const Vec3& d) -> Vec3 {
        const auto& shape = *static_cast<const S*>(p);
        return shape.support(d) - share_peeled * shape.least_radius() / d.norm() * d;
      };
      const double peel = share_peeled * s.least_radius();
      return {{&s, support, s.bounding_radius() - s.rounding() - peel}, peel};
    } else {
      return {ConvexRef::to(s), 0.0};
    }
  }

 private:
  static constexpr double share_peeled = 0.9;  // the eroded core has a smooth surface
};

/// Two cores and their quick distance, which may be null.
struct CorePair {
  ConvexRef a, b;
  QuickDistance quick;
  PeeledCore peeled_a = {}, peeled_b = {};  ///< where one is round and there is no quick distance

  template <class A, class B>
  static CorePair of(const A& a, const B& b) {
    CorePair pair{ConvexRef::to(a), ConvexRef::to(b), quick_distance<A, B>()};
    if constexpr (quick_distance<A, B>() == nullptr && (RoundShape<A> || RoundShape<B>)) {
      pair.peeled_a = PeeledCore::of(a);
      pair.peeled_b = PeeledCore::of(b);
    }
    return pair;
  }
};

/// One point: the quick distance; where it is not certain, GJK while the cores are apart and EPA otherwise.
void collide_cores(const CorePair& cores, const RoundedPair& rounded, const PairQuery& q, ContactSink& sink);

/// The same where both are round, with the effective radius of their curvatures. known: their quick distance within
/// quick_limit(), if it has been found already.
void collide_round(const CorePair& cores, const RoundRef& a, const RoundRef& b, const RoundedPair& rounded,
                   const PairQuery& q, ContactSink& sink, const CommonNormal* known = nullptr);
inline double quick_limit(const RoundedPair& r, const PairQuery& q) { return q.reach + r.sweep_a + r.sweep_b; }

/// The same where one is a polyhedron and the other has flat sides: up to 4 points. `sides`: of the core, as in
/// CoreAndPolyhedron.
struct FlatCore {
  const PolyhedronView& polyhedron;
  const void* shape;
  FlatSide (*facing)(const void* shape, const Vec3& d);
  bool polyhedron_first;  ///< it is A
};
void collide_flat_core(const CorePair& cores, const FlatCore& sides, const RoundedPair& rounded, const PairQuery& q,
                       ContactSink& sink);

/// The same where neither is a polyhedron and both have flat sides.
struct FlatSides {
  FlatSide (*facing_a)(const void* shape, const Vec3& d);
  FlatSide (*facing_b)(const void* shape, const Vec3& d);
};
void collide_flat_pair(const CorePair& cores, const FlatSides& sides, const RoundedPair& rounded, const PairQuery& q,
                       ContactSink& sink);

template <HasFlatSides S>
FlatSide facing_of(const void* shape, const Vec3& d) {
  return static_cast<const S*>(shape)->facing(d);
}

/// Signed distance by features, up to 4 points by clipping.
void collide_polyhedra(const PolyhedronView& a, const PolyhedronView& b, const RoundedPair& rounded, const PairQuery& q,
                       ContactSink& sink);

template <class A, class B>
RoundedPair rounded_pair(const A& a, const B& b) {
  return {a.rounding(), b.rounding(), TouchingRadius::of(a), TouchingRadius::of(b)};
}

/// True if bounding spheres or the axis of the last query separate the bodies; tested first, since this holds for two
/// thirds of the pairs of a bed of boxes. The separation must exceed the reach by more than rounding, so a search would
/// find no contact either: the memory of a pair cannot change a result.
template <ConvexShape A, ConvexShape B>
bool still_apart(const A& a, const B& b, const PairQuery& q) {
  const Vec3 between = q.b.position - q.a.position;
  const double sweeps = a.rounding() + b.rounding(), size = a.bounding_radius() + b.bounding_radius();
  const double limit = q.area ? 0.0 : q.reach + sweeps;  // an area is that of an overlap
  const double far = size - sweeps + limit;
  if (between.squaredNorm() > far * far) return true;
  if (!q.cache || !(q.cache->axis.squaredNorm() > 0.0)) return false;
  const Vec3& n = q.cache->axis;
  const Vec3 in_a = q.a.orientation.conjugate() * n;
  const Vec3 in_b = q.b.orientation.conjugate() * Vec3(-n);
  const double gap = n.dot(between) - in_a.dot(a.support(in_a)) - in_b.dot(b.support(in_b));
  return gap > limit + 4e-12 * size;
}

/// Separated pairs keep no resting patch.
void leave_rest(const PairQuery& q);

/// The default for two convex shapes. A closed form (collide_closed) replaces it.
template <ConvexShape A, ConvexShape B>
void collide(const A& a, const B& b, const PairQuery& q, ContactSink& sink) {
  if (still_apart(a, b, q)) return leave_rest(q);
  const RoundedPair rounded = rounded_pair(a, b);
  if constexpr (PolyhedralShape<A> && RestsFlat<B>)
    if (q.reach > 0.0)
      return collide_flat_core(CorePair::of(a, b), {a.view(), &b, resting_side_of<B>, true}, rounded, q, sink);
  if constexpr (RestsFlat<A> && PolyhedralShape<B>)
    if (q.reach > 0.0)
      return collide_flat_core(CorePair::of(a, b), {b.view(), &a, resting_side_of<A>, false}, rounded, q, sink);
  if constexpr (PolyhedralShape<A> && PolyhedralShape<B>) {
    collide_polyhedra(a.view(), b.view(), rounded, q, sink);
  } else if constexpr (PolyhedralShape<A> && HasFlatSides<B>) {
    collide_flat_core(CorePair::of(a, b), {a.view(), &b, facing_of<B>, true}, rounded, q, sink);
  } else if constexpr (HasFlatSides<A> && PolyhedralShape<B>) {
    collide_flat_core(CorePair::of(a, b), {b.view(), &a, facing_of<A>, false}, rounded, q, sink);
  } else if constexpr (HasFlatSides<A> && HasFlatSides<B>) {
    collide_flat_pair(CorePair::of(a, b), {facing_of<A>, facing_of<B>}, rounded, q, sink);
  } else if constexpr (RoundShape<A> && RoundShape<B>) {
    collide_round(CorePair::of(a, b), RoundRef::to(a), RoundRef::to(b), rounded, q, sink);
  } else {
    collide_cores(CorePair::of(a, b), rounded, q, sink);
  }
}

}  // namespace epafi
