/// @file shape_concept.h  What a shape offers to the rest of the engine. A new shape is one header with these
/// functions.
#pragma once
#include <concepts>

#include "detection/aabb.h"
#include "engine/state/types.h"
#include "engine/units/registry.h"

namespace epafi {

/// Mass [kg], centre [m] and inertia tensor about the centre [kg m^2] of a body of density 1 unless stated.
struct MassProperties {
  double mass = 0.0;
  Vec3 centre = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
};

/// Bounded body with a volume. Coordinates are the body's own: origin at the centre of mass, axes principal.
template <class S>
concept SolidShape = requires(const S& s, const Pose& pose) {
  { S::name } -> std::convertible_to<const char*>;
  { s.bounding_radius() } -> std::same_as<double>;          ///< of the sphere about the origin that contains it [m]
  { s.bounding_box(pose) } -> std::same_as<Aabb>;           ///< in world axes
  { s.mass_properties() } -> std::same_as<MassProperties>;  ///< at density 1, about the origin
};

/// Convex body known by its support function: support(d) = argmax over the body of d.x, d in body axes, any length > 0.
/// The body GJK sees is the core; `rounding()` is the radius of a sphere swept over it (0 for sharp bodies).
template <class S>
concept ConvexShape = requires(const S& s, const Vec3& d) {
  { s.support(d) } -> std::same_as<Vec3>;
  { s.rounding() } -> std::same_as<double>;
};

/// The core of a body of revolution with straight sides, axis z: cylinder; a segment, r = 0; a point, r = h = 0.
struct CylinderCore {
  double radius;       ///< r [m], >= 0
  double half_length;  ///< h [m], >= 0
};

/// A support point x(d) and its derivative along unit directions d: symmetric, zero along d, with the radii of
/// curvature as its other eigenvalues [m].
struct CurvedSupport {
  Vec3 point;
  Mat3 derivative;
};

}  // namespace epafi
