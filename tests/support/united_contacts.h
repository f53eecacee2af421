/// @file united_contacts.h  Contacts of listed pairs as a step finds them: walls act as one surface, points are few.
#pragma once
#include "detection/narrow/narrow_phase.h"

namespace epafi::testing {

inline ContactSet united_contacts(const World& world, const ShapeStore& shapes, PairList& list, double reach = 0.0) {
  list.generation = 1;
  BatchNarrowPhase narrow(shapes, reach, false);
  narrow.join_walls();
  ContactSet found;
  narrow.collide(world, list, found);
  narrow.unite(world, found);
  return found;
}

/// Of the last body with all others.
inline ContactSet united_contacts_of_last(const World& world, const ShapeStore& shapes, double reach = 0.0) {
  PairList list;
  const auto body = static_cast<Slot>(world.size() - 1);
  for (Slot wall = 0; wall < body; ++wall) list.pairs.push_back({wall, body});
  return united_contacts(world, shapes, list, reach);
}

}  // namespace epafi::testing
