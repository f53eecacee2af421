#include "detection/shapes/convex_parts.h"

#include <CGAL/Gmpq.h>
#include <CGAL/Nef_polyhedron_3.h>
#include <CGAL/Polyhedron_3.h>
#include <CGAL/Polyhedron_incremental_builder_3.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/convex_decomposition_3.h>

#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "detection/mass_properties.h"

namespace epafi {
namespace {

using Exact = CGAL::Simple_cartesian<CGAL::Gmpq>;  // compiles in 13 s where the lazy exact kernel takes 18, runs as fast here
using ExactSurface = CGAL::Polyhedron_3<Exact>;
using Nef = CGAL::Nef_polyhedron_3<Exact>;

constexpr double same_volume = 1e-9;  // relative: two parts whose hull has their volume are one convex part

struct Builder : CGAL::Modifier_base<ExactSurface::HalfedgeDS> {
  explicit Builder(const TriangleSurface& s) : surface(s) {}
  void operator()(ExactSurface::HalfedgeDS& out) override {
    CGAL::Polyhedron_incremental_builder_3<ExactSurface::HalfedgeDS> builder(out);
    builder.begin_surface(surface.vertices.size(), surface.triangles.size());
    for (const Vec3& v : surface.vertices) builder.add_vertex(Exact::Point_3(v.x(), v.y(), v.z()));
    for (const Triangle& t : surface.triangles) {
      if (!builder.test_facet(t.begin(), t.end())) {
        ok = false;
        break;
      }
      builder.add_facet(t.begin(), t.end());
    }
    builder.end_surface();
  }
  const TriangleSurface& surface;
  bool ok = true;
};

/// Corners of every convex piece; nothing where the surface is no boundary of a solid.
std::vector<std::vector<Vec3>> pieces(const TriangleSurface& surface) {
  ExactSurface polyhedron;
  Builder builder(surface);
  polyhedron.delegate(builder);
  if (!builder.ok || !polyhedron.is_closed()) return {};
  Nef nef(polyhedron);
  CGAL::convex_decomposition_3(nef);
  std::vector<std::vector<Vec3>> out;
  for (auto volume = ++nef.volumes_begin(); volume != nef.volumes_end(); ++volume) {  // the first is the outside
    if (!volume->mark()) continue;
    ExactSurface piece;
    nef.convert_inner_shell_to_polyhedron(volume->shells_begin(), piece);
    auto& corners = out.emplace_back();
    for (auto p = piece.points_begin(); p != piece.points_end(); ++p)
      corners.emplace_back(CGAL::to_double(p->x()), CGAL::to_double(p->y()), CGAL::to_double(p->z()));
  }
  return out;
}

/// Nothing where the points enclose no volume worth a body (`least` [m^3]).
std::optional<ConvexPart> hull_of(std::span<const Vec3> points, double least) {
  try {
    ConvexPart part{hull_from_points(points)};
    const MassProperties whole = surface_mass_properties(part.surface.vertices, triangles_of(part.surface));
    part.volume = whole.mass, part.centre = whole.centre;
    if (part.volume > least) return part;
  } catch (const SceneError&) {
  }  // flat: rounding to double closed it
  return std::nullopt;
}

/// Joins pairs whose hull has no more volume than they have, until there are none.
void join(std::vector<ConvexPart>& parts) {
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t j = 0; j < parts.size(); ++j) {
      if (i == j) continue;
      auto points = parts[i].surface.vertices;
      points.insert(points.end(), parts[j].surface.vertices.begin(), parts[j].surface.vertices.end());
      auto both = hull_of(points, 0.0);
      const double sum = parts[i].volume + parts[j].volume;
      if (!both || both->volume > sum * (1 + same_volume)) continue;
      parts[i] = std::move(*both);
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(j));
      if (j < i) --i;
      j = std::size_t(-1);  // what grew may join what it could not before
    }
}

}  // namespace

std::vector<ConvexPart> convex_parts(const TriangleSurface& surface, const Place& place) {
  const double volume = surface_mass_properties(surface).mass;
  std::vector<std::vector<Vec3>> corners;
  try {
    corners = pieces(surface);
  } catch (const std::exception&) {  // a precondition of CGAL: reported below with the cause a user can mend
  }
  std::vector<ConvexPart> parts;
  double sum = 0;
  for (const auto& c : corners)
    if (auto part = hull_of(c, 1e-12 * volume)) sum += part->volume, parts.push_back(std::move(*part));
  if (!(std::abs(sum - volume) <= same_volume * volume))
    throw SceneError(
        fmt::format("the surface cannot be cut into convex parts: they hold {:.6g} of {:.6g} m^3. It crosses or touches "
                    "itself; mend it in a mesh editor, or write polyhedron = {{ file = ... }} for its convex hull",
                    sum, volume),
        place);
  join(parts);
  return parts;
}

}  // namespace epafi
