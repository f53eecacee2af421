/// @file solid_parts.h  Closed surface of triangles as a rigid body ("solid" in scenes, and a mesh that moves freely):
/// convex parts that touch on their own. Mass properties are those of the surface, exact by its tetrahedra. Body axes:
/// origin at the centre of mass, axes principal. Limit: parts meet along inner faces; a contact deep enough to reach
/// the end of such a face may be affected.
#pragma once
#include <vector>

#include "detection/mass_properties.h"
#include "detection/shapes/convex_hull.h"
#include "detection/shapes/hull_from_points.h"
#include "engine/units/error.h"

namespace epafi {

/// One part as the narrow phase sees it: a polyhedron about its own centre.
struct SolidPart {
  const ConvexHull* hull;
  double radius;  ///< effective radius of the whole body [m]

  operator const ConvexHull&() const { return *hull; }
  Vec3 support(const Vec3& d) const { return hull->support(d); }
  double rounding() const { return 0.0; }
  PolyhedronView view() const { return hull->view(); }
  double bounding_radius() const { return hull->radius; }
  double contact_radius() const { return radius; }
};
static_assert(PolyhedralShape<SolidPart>);

struct SolidParts {
  static constexpr const char* name = "solid";
  static constexpr std::size_t most_parts = 256;  ///< the number of a part stands in eight bits of a contact's feature

  struct Placed {
    ConvexHull hull;  ///< about its own centre of mass, in the axes of the body
    Vec3 centre;      ///< body axes [m]
    Aabb box;         ///< the same
    Placed(ConvexHull about_centre, const Vec3& at)
        : hull(std::move(about_centre)), centre(at), box(hull.bounding_box(Pose{at, Quat(1, 0, 0, 0)})) {}
  };
  std::vector<Placed> parts;
  HullSurface outline;          ///< convex hull of all, body axes: its corners carry the body on a plane; may be empty
  TriangleSurface surface;      ///< body axes; for pictures
  double volume = 0.0;          ///< [m^3]
  Mat3 inertia = Mat3::Zero();  ///< about the origin at density 1 [kg m^2]
  double radius = 0.0;          ///< of the sphere about the origin that contains it [m]
  double equal_radius = 0.0;    ///< of the sphere of equal volume [m]

  static Entry entry() {
    return {name,
            "closed surface as a free body: convex parts, exact mass properties",
            {{"file", "", "", Kind::text, {}, {}, "OBJ, STL or PLY file of a closed surface"}},
            {},
            "Thibault and Naylor 1987"};
  }

  using Part = SolidPart;
  std::size_t part_count() const { return parts.size(); }
  SolidPart part(std::size_t k) const { return {&parts[k].hull, contact_radius()}; }
  Pose part_pose(std::size_t k, const Pose& pose) const { return {pose.to_world(parts[k].centre), pose.orientation}; }

  double bounding_radius() const { return radius; }
  double contact_radius() const { return equal_radius; }
  Aabb bounding_box(const Pose& pose) const;
  MassProperties mass_properties() const { return {volume, Vec3::Zero(), inertia}; }
};
static_assert(SolidShape<SolidParts>);

/// The surface cut into convex parts, in its own principal axes; frame: where these lie in the author's.
struct PlacedSolid {
  SolidParts solid;
  PrincipalFrame frame;
};

/// Throws SceneError at `place` where the surface is not closed (which edges), crosses itself, or has too many parts.
[[nodiscard]] PlacedSolid place_solid(TriangleSurface surface, const Place& place = {});

}  // namespace epafi
