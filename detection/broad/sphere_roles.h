/// @file sphere_roles.h  Which pairs go to PairList::spheres: those of spheres, free, held or balls of clumps, and of
/// what moves of these with half-spaces that never move. Their contact model detects them itself, so they are listed as
/// it reads them.
#pragma once
#include <cstdint>
#include <vector>

#include "detection/shape_store.h"
#include "engine/state/contacts.h"

namespace epafi {

enum class SphereRole : std::uint8_t {
  none,
  sphere,  ///< free
  balls,   ///< a clump, or a sphere that is held: detection/broad/ball_pairs.h
  plane
};

/// Bodies whose pairs of spheres the contact model of a scene takes.
struct SphereRoles {
  bool wanted = false;
  std::vector<bool> fixed{};  ///< by body id: bodies that never move; ids beyond it are free
  bool held = false;          ///< spheres and clumps that are fixed or driven are wanted too

  bool is_fixed(const World& world, Slot s) const {
    const auto id = static_cast<std::size_t>(world.id[s]);
    return id < fixed.size() && fixed[id];
  }
  SphereRole of(const World& world, Slot s) const {
    const std::uint32_t type = ShapeRef{world.shape[s]}.type();
    const bool free = world.is_movable(s);
    if (type == ShapeStore::type_of<Sphere>()) return free ? SphereRole::sphere : as_balls(held);
    if (type == ShapeStore::type_of<Clump>()) return as_balls(free || held);
    return type == ShapeStore::type_of<HalfSpace>() && is_fixed(world, s) ? SphereRole::plane : SphereRole::none;
  }

 private:
  static SphereRole as_balls(bool taken) { return taken ? SphereRole::balls : SphereRole::none; }
};

/// Moves pairs of free spheres, and of these with planes, of a complete list, images among them, to `spheres`.
void take_spheres(const World& world, const SphereRoles& roles, PairList& pairs);

/// Puts a run of partners, a handful, in order: by partner, then by the key of the contact.
void sort_partners(Slot* partner, std::uint32_t* image, std::size_t n);

}  // namespace epafi
