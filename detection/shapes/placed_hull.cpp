#include "detection/shapes/placed_hull.h"

namespace epafi {

PlacedHull place_hull(std::span<const Vec3> points, double sweep, const Place& place) {
  HullSurface surface = hull_from_points(points, place);
  const PrincipalFrame frame = principal_frame(surface_mass_properties(surface.vertices, triangles_of(surface)));
  for (Vec3& v : surface.vertices) v = frame.to_principal(v);
  ConvexHull::Built built = ConvexHull::from_faces(std::move(surface.vertices), surface.faces);
  if (!built.problem.empty()) throw SceneError("the polyhedron cannot be used: " + built.problem, place);
  built.hull.sweep = sweep;
  return {std::move(built.hull), frame};
}

}  // namespace epafi
