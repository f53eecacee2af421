#include "scenes/law_potential.h"

#include <algorithm>

#include "detection/shapes/rounded_shapes.h"
#include "scenes/contact_setup.h"

namespace epafi {
namespace {

constexpr double nearly_elastic = 0.9;  // restitution above which an open balance is not small beside the losses

bool has_flat_sides(std::uint32_t type) {
  return type == ShapeStore::type_of<Box>() || type == ShapeStore::type_of<ConvexHull>() ||
         type == ShapeStore::type_of<SolidParts>() || type == ShapeStore::type_of<Cylinder>();
}

/// At least two bodies with flat sides that move, now or when all are poured.
bool some_may_meet(const Assembly& a) {
  std::size_t count = 0;
  const World& world = a.simulation->world;
  for (Slot s = 0; s < world.size() && count < 2; ++s)
    count += world.is_movable(s) && has_flat_sides(ShapeRef{world.shape[s]}.type());
  for (const PourBodies* source : a.sources)
    for (const auto& b : source->setup().bodies) count += has_flat_sides(ShapeRef{b.body.shape}.type());
  return count > 1;
}

}  // namespace

std::string way_to_a_potential(const Assembly& a) {
  if (a.scene.contact.method.value != Method::smooth || a.plan.needs.area || !some_may_meet(a)) return "";
  return "law '" + a.scene.contact.law.value +
         "' has no potential where polyhedra or cylinders meet each other; write law = \"overlap-volume\" (sharp "
         "polyhedra, boxes and half-spaces) or method = \"nonsmooth\"";
}

void warn_of_missing_potential(Assembly& a) {
  const std::string way = way_to_a_potential(a);
  if (way.empty()) return;
  const MaterialTable table = smooth_setup(a.scene).materials;
  const bool elastic = std::ranges::any_of(
      table.pairs, [](const MaterialPair& p) { return p.occurs && p.restitution > nearly_elastic; });
  if (!elastic) return;
  const ContactSettings& c = a.scene.contact;
  a.warnings.push_back({Problem::Level::warning, c.law.place.line > 0 ? c.law.place : c.method.place,
                        "elastic bodies may gain or lose a tenth of their energy in a second: " + way});
}

}  // namespace epafi
