#include "scenes/periodic_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace epafi {

namespace {

/// The largest free body.
struct Largest {
  double radius = 0.0, density = 0.0;  ///< [m], [kg/m^3]
  std::string name;                    ///< for messages
};

Largest largest_body(const Assembly& a) {
  Largest out;
  const auto look = [&](std::uint32_t shape, double mass, const auto& name) {
    const double r = a.shapes->bounding_radius({shape});
    if (r > out.radius) out = {r, mass / (4.0 / 3.0 * 3.14159265358979323846 * r * r * r), name()};
  };
  const World& w = a.simulation->world;
  for (Slot s = 0; s < w.size(); ++s)
    if (w.is_movable(s)) look(w.shape[s], 1.0 / w.inverse_mass[s], [&] { return "'" + body_name(a, w.id[s]) + "'"; });
  for (const auto* source : a.sources)
    for (const auto& b : source->setup().bodies)
      look(b.body.shape, b.body.mass, [] { return std::string("a body that is poured"); });
  return out;
}

void check_walls(const Assembly& a) {
  const World& w = a.simulation->world;
  const PeriodicCell& cell = *w.cell;
  const CellSpec& spec = *a.scene.cell;
  for (Slot s = 0; s < w.size(); ++s) {
    if (w.is_movable(s)) continue;
    const ShapeRef ref{w.shape[s]};
    if (ref.type() != ShapeStore::type_of<HalfSpace>()) {
      if (spec.deforms)
        throw SceneError("[world] domain: a cell that deforms holds free bodies and half-spaces, not '" +
                             body_name(a, w.id[s]) + "'",
                         spec.place);
      continue;
    }
    const Vec3 n = w.pose(s).orientation * a.shapes->of<HalfSpace>()[ref.index()].normal;
    for (int k = 0; k < 3; ++k)
      if (cell.repeats[static_cast<std::size_t>(k)] && std::abs(n[k]) > 1e-9)
        throw SceneError(fmt::format("[world] domain: the half-space '{}' faces along {}, where the domain repeats",
                                     body_name(a, w.id[s]), "xyz"[k]),
                         spec.place);
  }
}

/// What is held stands where it is written if that is within a cell of the cell, as far as its images reach; else an
/// image of it does. The middle of its box counts: a mesh may be drawn far from its own point.
void place_held(World& w, const ShapeStore& shapes) {
  const PeriodicCell& cell = *w.cell;
  for (Slot s = 0; s < w.size(); ++s) {
    if (w.is_movable(s) || ShapeRef{w.shape[s]}.type() == ShapeStore::type_of<HalfSpace>()) continue;
    const Vec3 middle = shapes.bounding_box(w, s).centre();
    if (!middle.allFinite()) continue;
    for (int k = 0; k < 3; ++k) {
      const double n = cell.cells_to(middle, k);
      if (!(std::abs(n) > 1.0 && std::abs(n) < 1e9)) continue;
      w.position[s][k] -= n * cell.size[k];
      w.wraps[s][k] += static_cast<int>(n);
    }
  }
}

}  // namespace

void add_cell(Assembly& a) {
  const CellSpec& spec = *a.scene.cell;
  const Largest largest = largest_body(a);
  for (int k = 0; k < 3; ++k)
    if (spec.cell.repeats[static_cast<std::size_t>(k)] && spec.cell.size[k] < 4 * largest.radius)
      throw SceneError(
          fmt::format("[world] domain: {:g} m along {}, where it repeats, is less than two diameters of the largest "
                      "free body ({}, {:g} m across): it may be near two images of another one at once; make the "
                      "domain {:g} m wide or more and repeat what is in it, or the body smaller",
                      spec.cell.size[k], "xyz"[k], largest.name, 2 * largest.radius, 4 * largest.radius),
          spec.place);
  if (spec.deforms && a.scene.contact.method.value == Method::nonsmooth)
    throw SceneError("[world] domain: strain_rate and pressure work with contact.method = \"smooth\"", spec.place);
  check_walls(a);
  place_held(a.simulation->world, *a.shapes);
  auto& events = a.simulation->events;
  if (spec.deforms) {
    CellControl control = spec.control;
    // an inertial number of 1e-3: quasi-static (GDR MiDi 2004)
    if (control.pressure && control.rate_limit == 0.0)
      control.rate_limit = 1e-3 * std::sqrt(*control.pressure / largest.density) / (2 * largest.radius);
    events.push_back(std::make_unique<DeformCell>(control, a.elapsed({})));
  }
  events.push_back(std::make_unique<WrapBodies>(largest.radius));
}

}  // namespace epafi
