#include "detection/shapes/solid_parts.h"

#include <fmt/format.h>

#include <cmath>

#include "detection/aabb.h"
#include "detection/shapes/convex_parts.h"
#include "detection/shapes/face_finder.h"
#include "detection/shapes/mesh_file.h"
#include "detection/shapes/rounded_shapes.h"

namespace epafi {
namespace {

/// How far the corners of plane faces lie off their planes: the deepest groove between two triangles that is too
/// shallow to be meant (of the diagonal), where several sides are so shallow or corners have been moved into planes.
/// Ridges alone tell nothing: a fine convex surface has them.
double groove_depth(const TriangleSurface& s, const JoinReport& report) {
  constexpr double meant = 1e-5;
  const int several = report.moved > 0 ? 1 : 4;  // one or two of exact faces may be meant
  Aabb box;
  for (const Vec3& v : s.vertices) box.include(v);
  const double most = meant * box.extent().norm();
  const auto uses = sorted_edge_uses(s.triangles);
  const auto height = [&](const EdgeUse& over, const EdgeUse& of) {
    const FacePlane plane = plane_of(s, s.triangles[over.triangle]);
    double high = 0.0;
    for (const std::uint32_t v : s.triangles[of.triangle])
      if (v != of.low && v != of.high) high = plane.height(s.vertices[v]);
    return high;
  };
  double deepest = 0.0;
  int shallow = 0;
  for (std::size_t k = 0; k + 1 < uses.size(); k += 2) {  // a closed surface: two uses of each edge
    const double h1 = height(uses[k], uses[k + 1]), h2 = height(uses[k + 1], uses[k]);
    const double h = std::abs(h1) < std::abs(h2) ? h1 : h2;
    if (!(4.0 * std::abs(h) > report.flatness && std::abs(h) <= most)) continue;
    ++shallow;
    deepest = std::max(deepest, h);
  }
  return shallow < several ? 0.0 : deepest;
}

/// Joined, closed, its triangles counter-clockwise seen from outside.
JoinedSurface closed_surface(TriangleSurface given, double precision, const Place& place) {
  JoinedSurface joined = join_surface(std::move(given), precision);
  const MeshReport report = inspect(joined.surface);
  if (!report.is_watertight())
    throw SceneError(report.to_string() + "; a body that moves freely needs a closed surface", place);
  if (report.is_inverted())
    for (Triangle& t : joined.surface.triangles) std::swap(t[1], t[2]);
  return joined;
}

}  // namespace

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
  JoinedSurface joined = closed_surface(std::move(given), precision, place);
  if (const double off = groove_depth(joined.surface, joined.report); off > 0.0) {
    precision = off;  // the digits of the file promise more than its faces hold
    joined = closed_surface(std::move(joined.surface), precision, place);
  }
  TriangleSurface& surface = joined.surface;
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
