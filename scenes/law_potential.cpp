#include "scenes/law_potential.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "detection/shapes/rounded_shapes.h"
#include "scenes/contact_setup.h"

namespace epafi {
namespace {

constexpr double nearly_elastic = 0.9;  // restitution above which an open balance is not small beside the losses

bool has_flat_sides(std::uint32_t type) {
  return type == ShapeStore::type_of<Box>() || type == ShapeStore::type_of<ConvexHull>() ||
         type == ShapeStore::type_of<SolidParts>() || type == ShapeStore::type_of<Cylinder>();
}

/// Number of movable bodies with flat sides by material, including those to be poured.
std::vector<std::size_t> count_flat_sided(const Assembly& a) {
  std::vector<std::size_t> count(a.scene.materials.size(), 0);
  const World& world = a.simulation->world;
  for (Slot s = 0; s < world.size(); ++s)
    if (world.is_movable(s) && has_flat_sides(ShapeRef{world.shape[s]}.type())) ++count[world.material[s]];
  for (const PourBodies* source : a.sources)
    for (const auto& b : source->setup().bodies)
      if (has_flat_sides(ShapeRef{b.body.shape}.type())) ++count[b.body.material];
  return count;
}

/// Place in the scene of the restitution of two materials; i <= j.
Place place_of_restitution(const Scene& scene, std::size_t i, std::size_t j) {
  for (const PairSpec& p : scene.contact.pairs)
    if (p.restitution && p.a == i && p.b == j) return p.place;
  const ContactSettings& c = scene.contact;
  return c.restitution.place.line > 0 ? c.restitution.place : c.method.place;
}

}  // namespace

std::string way_to_a_potential(const Assembly& a) {
  if (a.scene.contact.method.value != Method::smooth || a.plan.needs.area) return "";
  const std::vector<std::size_t> flat = count_flat_sided(a);
  if (std::accumulate(flat.begin(), flat.end(), std::size_t{0}) < 2) return "";
  return "law '" + a.scene.contact.law.value +
         "' has no potential where polyhedra or cylinders meet each other; write law = \"overlap-volume\" (sharp "
         "polyhedra, boxes and half-spaces) or method = \"nonsmooth\"";
}

void refuse_missing_potential(const Assembly& a) {
  const std::string way = way_to_a_potential(a);
  if (way.empty()) return;
  const std::vector<std::size_t> flat = count_flat_sided(a);
  const MaterialTable table = smooth_setup(a.scene).materials;
  for (std::size_t i = 0; i < flat.size(); ++i)
    for (std::size_t j = i; j < flat.size(); ++j) {
      const double e = table.pairs[i * table.materials + j].restitution;
      const bool meet = i == j ? flat[i] > 1 : flat[i] > 0 && flat[j] > 0;
      if (!meet || !(e > nearly_elastic)) continue;
      throw SceneError(fmt::format("restitution = {:g}: such bodies would gain or lose a tenth of their energy in a "
                                   "second; {}; or restitution = {:g} or less, whose losses are larger than the error",
                                   e, way, nearly_elastic),
                       place_of_restitution(a.scene, i, j));
    }
}

}  // namespace epafi
