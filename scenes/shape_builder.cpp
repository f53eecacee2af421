#include "scenes/shape_builder.h"

#include <fmt/format.h>

#include <cmath>

#include "detection/shapes/mesh_file.h"
#include "detection/shapes/rounded_shapes.h"
#include "engine/units/random.h"
#include "engine/units/units.h"
#include "scenes/railway/profiles.h"
#include "scenes/shape_text.h"

namespace epafi {

namespace {

BuiltShape solid(ShapeRef ref, const MassProperties& mass, double radius, bool is_sphere = false) {
  return {ref, mass.mass, principal_frame(mass), radius, is_sphere, true};
}

/// The surface of a shape's file, in metres.
MeshFile read_surface(const ShapeSpec& spec, MeshFaces faces = MeshFaces::needed) {
  MeshFile file = read_mesh_file(spec.parameters.text("file"), faces);
  const Unit unit = *parse_unit(spec.parameters.has("unit") ? spec.parameters.text("unit") : "m").unit;
  for (Vec3& v : file.surface.vertices) v = v * unit.numerator / unit.denominator;
  file.report.precision *= unit.numerator / unit.denominator;
  return file;
}

/// The hull of the points as the author gave them.
HullSurface author_hull(const ShapeSpec& spec) {
  const Parameters& p = spec.parameters;
  if (p.has("vertices")) return hull_from_points(p.vectors("vertices"), spec.place);
  if (p.has("file")) {
    const MeshFile file = read_surface(spec, MeshFaces::optional);
    return hull_from_points(file.surface.vertices, spec.place, file.report.precision);
  }
  // random points on a sphere of diameter 1: uniform by the cylinder's map (Archimedes)
  std::vector<Vec3> points;
  Random random(static_cast<std::uint64_t>(p.integer("random.seed")), 0);
  for (long long k = 0; k < p.integer("random.vertices"); ++k) {
    const double z = random.uniform(-1, 1), angle = random.uniform(0, 2 * M_PI), r = std::sqrt(1 - z * z);
    points.push_back(0.5 * Vec3(r * std::cos(angle), r * std::sin(angle), z));
  }
  return hull_from_points(points, spec.place);
}

double largest_distance(const std::vector<Vec3>& points, const Vec3& from) {
  double radius = 0;
  for (const Vec3& v : points) radius = std::max(radius, (v - from).norm());
  return radius;
}

/// Distances are squared and multiplied by each other: beyond these lengths [m] that leaves the range of numbers.
void check_extent(const ShapeSpec& spec, double radius) {
  constexpr double least = 1e-60, most = 1e60;
  const bool endless = spec.type == "half_space" || spec.type == "rail_profile";
  if (endless || (radius >= least && radius <= most)) return;
  throw SceneError(fmt::format("a {} that reaches {:.3g} m from its centre; expected {:.0e} to {:.0e} m", spec.type,
                               radius, least, most),
                   spec.place);
}

}  // namespace

BuiltShape ShapeBuilder::build(std::size_t shape, double size) {
  const auto key = std::pair(shape, size);
  if (const auto found = built_.find(key); found != built_.end()) return found->second;
  const ShapeSpec& spec = scene_.shapes[shape];
  if (spec.scale_to_diameter && spec.type == "sphere")
    size *= *spec.scale_to_diameter / (2 * spec.parameters.number("radius"));
  const BuiltShape out = build_new(spec, size);
  check_extent(spec, out.radius);
  constexpr std::size_t most_kept = 1000;  // a map of a million radii would take as much as their bodies
  if (!out.is_sphere || built_.size() < most_kept) built_.emplace(key, out);
  if (!out.is_sphere)
    origins_[out.ref.packed] = {[&spec] { return shape_text(spec); }, key.second, out.frame.orientation,
                                out.frame.centre};
  return out;
}

BuiltShape ShapeBuilder::build_new(const ShapeSpec& spec, double size) {
  const Parameters& p = spec.parameters;
  const auto add = [&](auto s) {
    const MassProperties mass = s.mass_properties();
    const double radius = s.bounding_radius();
    return solid(store_.add(std::move(s)), mass, radius, spec.type == "sphere");
  };
  if (spec.type == "sphere") return add(Sphere{size * p.number("radius")});
  if (spec.type == "box") return add(Box(0.5 * size * p.vec3("size")));
  if (spec.type == "capsule") return add(Capsule(size * p.number("radius"), size * p.number("length")));
  if (spec.type == "cylinder") return add(Cylinder(size * p.number("radius"), size * p.number("length")));
  if (spec.type == "ellipsoid") return add(Ellipsoid(size * p.vec3("semi_axes")));
  if (spec.type == "superquadric")
    return add(Superquadric(size * p.vec3("semi_axes"), static_cast<int>(p.number("across")),
                            static_cast<int>(p.number("along"))));
  if (spec.type == "polyhedron") return build_hull(spec, size);
  if (spec.type == "clump") return build_clump(spec, size);
  if (spec.type == "solid") return build_solid(spec, size);
  if (spec.type == "mesh") return build_mesh(spec, size);
  if (spec.type == "half_space")
    return {store_.add(HalfSpace{p.vec3("normal").normalized()}), 0.0, {}, infinity, false, false};
  if (spec.type == "tube" || spec.type == "cone") return build_hollow(spec, size);
  if (spec.type == "wheel_profile") return build_wheels(spec);
  if (spec.type == "rail_profile")
    return {
        store_.add(RailProfile{std::make_shared<Track>(*build_track(p, spec.name).value), p.number("drawn_length")}),
        0.0,
        {},
        infinity,
        false,
        false};
  throw SceneError("shape '" + spec.type + "' cannot be built", spec.place);
}

BuiltShape ShapeBuilder::build_clump(const ShapeSpec& spec, double size) {
  const Parameters& p = spec.parameters;
  const auto& numbers = p.numbers("spheres");
  Clump clump;
  for (std::size_t k = 0; k + 3 < numbers.size(); k += 4)
    clump.parts.push_back({size * Vec3(numbers[k], numbers[k + 1], numbers[k + 2]), size * numbers[k + 3]});
  const MassProperties whole = clump.mass_properties();
  BuiltShape out = solid({}, whole, 0.0);
  if (p.has("mass")) {
    const double volume = size * size * size;
    out.mass = volume * p.number("mass");
    out.frame = {size * (p.has("centre") ? p.vec3("centre") : Vec3(whole.centre / size)), Quat(1, 0, 0, 0),
                 volume * size * size * p.vec3("inertia")};
  }
  for (PlacedBall& ball : clump.parts) ball.centre = out.frame.to_principal(ball.centre);
  out.radius = clump.bounding_radius();
  out.ref = store_.add(std::move(clump));
  return out;
}

BuiltShape ShapeBuilder::build_wheels(const ShapeSpec& spec) {
  auto wheelset = std::make_shared<Wheelset>(*build_wheelset(spec.parameters, spec.name).value);
  BuiltShape out;
  out.mass = wheelset->mass;
  out.frame.moments = wheelset->inertia;
  const WheelProfile shape{std::move(wheelset)};
  out.radius = shape.bounding_radius();
  out.is_solid = out.mass > 0;
  out.ref = store_.add(shape);
  return out;
}

BuiltShape ShapeBuilder::build_hull(const ShapeSpec& spec, double size) {
  HullSurface surface = author_hull(spec);
  const MassProperties author = surface_mass_properties(surface.vertices, triangles_of(surface));
  double factor = size;
  if (spec.scale_to_diameter)
    factor *= *spec.scale_to_diameter / (2 * largest_distance(surface.vertices, author.centre));
  PrincipalFrame frame = principal_frame(author);
  for (Vec3& v : surface.vertices) v = factor * frame.to_principal(v);
  surface.tolerance *= factor;
  auto built = built_hull(std::move(surface));
  if (!built.problem.empty()) {
    const std::string name = spec.parameters.has("file") ? spec.parameters.text("file") : spec.name;
    throw SceneError("the hull of '" + name + "': " + built.problem, spec.place);
  }
  built.hull.sweep = size * spec.rounding;
  const double f3 = factor * factor * factor, radius = built.hull.bounding_radius();
  frame.centre *= factor;
  frame.moments *= f3 * factor * factor;
  return {store_.add(std::move(built.hull)), author.mass * f3, frame, radius, false, true};
}

BuiltShape ShapeBuilder::build_solid(const ShapeSpec& spec, double size) {
  MeshFile file = read_surface(spec);
  warn_of(spec, file.report);
  auto& vertices = file.surface.vertices;
  if (spec.scale_to_diameter)
    size *= *spec.scale_to_diameter / (2 * largest_distance(vertices, surface_mass_properties(file.surface).centre));
  for (Vec3& v : vertices) v *= size;
  const Place place{spec.parameters.text("file"), 0, 0};
  PlacedSolid placed = place_solid(std::move(file.surface), place, size * file.report.precision);
  const double volume = placed.solid.volume, radius = placed.solid.radius;
  return {store_.add(std::move(placed.solid)), volume, placed.frame, radius, false, true};
}

void ShapeBuilder::warn_of(const ShapeSpec& spec, const MeshReport& report) {
  if (report.is_inverted() || report.dropped > 0)
    warnings_.push_back(
        {Problem::Level::warning, spec.place, spec.parameters.text("file") + ": " + report.to_string()});
}

BuiltShape ShapeBuilder::build_mesh(const ShapeSpec& spec, double size) {
  MeshFile file = read_surface(spec);
  warn_of(spec, file.report);
  for (Vec3& v : file.surface.vertices) v *= size;
  TriangleMesh mesh = TriangleMesh::from_surface(std::move(file.surface), size * file.report.precision);
  if (mesh.triangles.empty())
    throw SceneError(fmt::format("{}: no triangle is higher than {:.2g} m, within which the surface is joined",
                                 spec.parameters.text("file"), mesh.joined.tolerance),
                     spec.place);
  if (spec.parameters.text("tree") == "obb") mesh.orient_boxes();
  const double radius = mesh.bounding_radius();
  return {store_.add(std::move(mesh)), 0.0, {}, radius, false, false};
}

BuiltShape ShapeBuilder::build_hollow(const ShapeSpec& spec, double size) {
  const Parameters& p = spec.parameters;
  const double length = size * p.number("length");
  const bool closed = p.text("ends") == "closed";
  BuiltShape out;
  out.is_solid = false;
  const auto add = [&](auto shape) {
    out.radius = shape.bounding_radius();
    out.ref = store_.add(shape);
  };
  if (spec.type == "tube")
    add(Tube(size * p.number("radius"), length, closed));
  else
    add(Cone(size * p.numbers("radii")[0], size * p.numbers("radii")[1], length, closed));
  return out;
}

}  // namespace epafi
