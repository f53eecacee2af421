/// @file sphere_roles.h  Which pairs go to PairList::spheres: those of free spheres, and of free spheres with
/// half-spaces that never move. Their contact model detects them itself, so they are listed as it reads them.
#pragma once
#include <cstdint>
#include <vector>

#include "detection/shape_store.h"
#include "engine/state/contacts.h"

namespace epafi {

enum class SphereRole : std::uint8_t { none, sphere, plane };

/// Of a scene whose contact model takes such pairs.
struct SphereRoles {
  bool wanted = false;
  std::vector<bool> fixed{};  ///< by body id: bodies that never move; ids beyond it are free

  bool is_fixed(const World& world, Slot s) const {
    const auto id = static_cast<std::size_t>(world.id[s]);
    return id < fixed.size() && fixed[id];
  }
  SphereRole of(const World& world, Slot s) const {
    const std::uint32_t type = ShapeRef{world.shape[s]}.type();
    if (type == ShapeStore::type_of<Sphere>()) return world.is_movable(s) ? SphereRole::sphere : SphereRole::none;
    return type == ShapeStore::type_of<HalfSpace>() && is_fixed(world, s) ? SphereRole::plane : SphereRole::none;
  }
};

/// Moves such pairs of a complete list, images among them, to `spheres`.
void take_spheres(const World& world, const SphereRoles& roles, PairList& pairs);

}  // namespace epafi
