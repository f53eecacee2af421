/// @file pair_radius.h  R* of a pair of shapes other than spheres. A round body on the side of a cylinder touches along
/// Hertz' ellipse; two such sides, whose ellipse has no end where they are parallel, count by the mean of their
/// curvatures. A flat side has infinite radius, so R* is the other body's radius. If both sides are flat, that of a
/// wall (fixed or driven body) counts as flat, else that of a polyhedron; of two equals both have the radius of the
/// sphere of equal volume.
#pragma once
#include <cmath>
#include <concepts>

#include "detection/narrow/pairs/hertz_radius.h"
#include "detection/narrow/pairs/pair_query.h"
#include "detection/shapes/shape_concept.h"

namespace epafi {

/// A shape whose radius depends on where it is touched: radius_towards(d), infinite on a flat, of a side that is
/// straight along and round across twice the radius across (the mean of its curvatures) [m]; d in body axes.
template <class S>
concept RadiusByDirection = requires(const S& s, const Vec3& d) {
  { s.radius_towards(d) } -> std::same_as<double>;
};

/// The radius of one body for R*, behind one function pointer.
struct TouchingRadius {
  const void* shape = nullptr;
  double (*radius_towards)(const void* shape, const Vec3& d) = nullptr;  ///< null: flat everywhere
  double on_flat = 0.0;                                                  ///< against a flat [m]; 0: as towards
  bool polyhedral = false;
  bool has_side = false;  ///< where it is not flat it is straight along

  double towards(const Vec3& d) const { return radius_towards ? radius_towards(shape, d) : infinity; }
  double against_flat(const Vec3& d) const { return on_flat > 0.0 ? on_flat : towards(d); }

  template <ConvexShape S>
  static TouchingRadius of(const S& s) {
    if constexpr (PolyhedralShape<S>) {
      return {&s, nullptr, contact_radius(s), true};
    } else if constexpr (RadiusByDirection<S>) {
      return {&s, [](const void* p, const Vec3& d) { return static_cast<const S*>(p)->radius_towards(d); },
              contact_radius(s), false, true};
    } else if constexpr (RoundShape<S>) {
      const auto towards = [](const void* p, const Vec3& d) {
        const S& round = *static_cast<const S*>(p);
        return hertz_radius_on_plane(RoundRef::to(round), round.rounding(), d);
      };
      return {&s, towards, 0.0, false};
    } else {
      return {&s, [](const void* p, const Vec3&) { return contact_radius(*static_cast<const S*>(p)); },
              contact_radius(s), false};
    }
  }
};

/// Both bodies where both are flat.
inline double radius_of_flats(const TouchingRadius& a, const TouchingRadius& b, const PairQuery& q) {
  const int rank_a = q.wall_a ? 2 : a.polyhedral ? 1 : 0, rank_b = q.wall_b ? 2 : b.polyhedral ? 1 : 0;
  if (rank_a == rank_b) return effective_radius(a.on_flat, b.on_flat);
  return rank_a > rank_b ? b.on_flat : a.on_flat;
}

/// R* [m]. n_a, n_b: unit normals that leave A and B where they touch, each in its own body's axes.
inline double pair_radius(const TouchingRadius& a, const TouchingRadius& b, const Vec3& n_a, const Vec3& n_b,
                          const PairQuery& q) {
  const double of_a = a.towards(n_a), of_b = b.towards(n_b);
  if (std::isinf(of_a) && std::isinf(of_b)) return radius_of_flats(a, b, q);
  if (std::isinf(of_a)) return b.against_flat(n_b);
  if (std::isinf(of_b)) return a.against_flat(n_a);
  if (a.has_side != b.has_side)
    return a.has_side ? wall_contact_radius(of_b, 2.0 / of_a) : wall_contact_radius(of_a, 2.0 / of_b);
  return effective_radius(of_a, of_b);
}

}  // namespace epafi
