/// @file mass_properties.h  Volume, centre and inertia of a closed triangle surface, and its principal frame.
/// Sum over signed tetrahedra with their apex in the middle of the surface (Mirtich 1996; Eberly 2002): exact but for
/// rounding, also far from the origin. A surface that is not closed or not oriented gives numbers without meaning.
#pragma once
#include <span>

#include "detection/shapes/shape_concept.h"
#include "detection/shapes/triangle_surface.h"

namespace epafi {

/// At density 1: volume [m^3], centre [m], inertia about the centre [m^5]. Volume < 0: the orientation is inside out.
[[nodiscard]] MassProperties surface_mass_properties(std::span<const Vec3> vertices,
                                                     std::span<const Triangle> triangles);
[[nodiscard]] inline MassProperties surface_mass_properties(const TriangleSurface& s) {
  return surface_mass_properties(s.vertices, s.triangles);
}

/// Inertia about the origin of a body whose inertia about its centre is known (Huygens-Steiner); about 0 of mass m.
[[nodiscard]] Mat3 inertia_about_origin(const MassProperties& body);

/// Principal axes of a geometry in the axes of its author: x_author = centre + orientation x_principal. A body that the
/// author places at position p with orientation q has its centre of mass at p and the principal orientation q *
/// orientation.
struct PrincipalFrame {
  Vec3 centre = Vec3::Zero();           ///< centre of mass, author's axes [m]
  Quat orientation = Quat(1, 0, 0, 0);  ///< principal to author's axes
  Vec3 moments = Vec3::Zero();          ///< about the principal axes [kg m^2] at density 1

  Vec3 to_principal(const Vec3& author) const { return orientation.conjugate() * (author - centre); }
  Vec3 to_author(const Vec3& principal) const { return centre + orientation * principal; }
};

/// Axes by Jacobi rotations. Of the 24 ways to name and sign them the one nearest to the author's axes is taken, and
/// off-diagonal moments below 1e-13 of the trace count as 0: an aligned body and a cube keep the author's axes.
[[nodiscard]] PrincipalFrame principal_frame(const MassProperties& body);

}  // namespace epafi
