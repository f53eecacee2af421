#include "detection/shapes/solid_parts.h"

#include <fmt/format.h>

#include <cmath>

#include "detection/shapes/convex_parts.h"
#include "detection/shapes/mesh_file.h"
#include "detection/shapes/rounded_shapes.h"

namespace epafi {

Aabb SolidParts::bounding_box(const Pose& pose) const {
  Aabb box{Vec3::Constant(infinity), Vec3::Constant(-infinity)};
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const Aabb one = parts[k].hull.bounding_box(part_pose(k, pose));
    box.min = box.min.cwiseMin(one.min);
    box.max = box.max.cwiseMax(one.max);
  }
  return box;
}

PlacedSolid place_solid(TriangleSurface surface, const Place& place) {
  return place_solid(std::move(surface), place, 0.0);
}

PlacedSolid place_solid(TriangleSurface given, const Place& place, double precision) {
  JoinedSurface joined = join_surface(std::move(given), precision);
  TriangleSurface& surface = joined.surface;
  const MeshReport report = inspect(surface);
  if (!report.is_watertight())
    throw SceneError(report.to_string() + "; a body that moves freely needs a closed surface", place);
  if (report.is_inverted())
    for (Triangle& t : surface.triangles) std::swap(t[1], t[2]);
  const MassProperties whole = surface_mass_properties(surface);
  PlacedSolid out{{}, principal_frame(whole)};
  // cut in the author's axes: turning rounds, and what was one plane would be several
  auto parts = convex_parts(joined, precision, place);
  for (Vec3& v : surface.vertices) v = out.frame.to_principal(v);
  SolidParts& solid = out.solid;
  solid.volume = whole.mass;
  solid.equal_radius = std::cbrt(solid.volume * 0.238732414637843);  // 3 over 4 pi
  solid.inertia = out.frame.moments.asDiagonal();
  for (const Vec3& v : surface.vertices) solid.radius = std::max(solid.radius, v.norm());
  for (ConvexPart& part : parts) {
    const Vec3 centre = out.frame.to_principal(part.centre);
    for (Vec3& v : part.surface.vertices) v = out.frame.to_principal(v) - centre;
    auto built = built_hull(std::move(part.surface));
    if (!built.problem.empty()) throw SceneError("a convex part of the surface " + built.problem, place);
    solid.parts.push_back({std::move(built.hull), centre});
  }
  if (solid.parts.size() > SolidParts::most_parts)
    throw SceneError(fmt::format("the surface has {} convex parts, at most {} can be carried; simplify it, or write "
                                 "polyhedron = {{ file = ... }} for its convex hull",
                                 solid.parts.size(), SolidParts::most_parts),
                     place);
  constexpr double rounding = 1e-13;  // of the radius
  solid.outline = hull_from_points(surface.vertices, place, precision + rounding * solid.radius);
  solid.surface = std::move(surface);
  return out;
}

}  // namespace epafi
