/// @file all_schemes.h  The list of time schemes: one line per entry.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "engine/schemes/moreau_jean.h"
#include "engine/schemes/symplectic_euler.h"
#include "engine/schemes/velocity_verlet.h"
#include "engine/units/registry.h"

namespace epafi {

struct SchemeEntry {
  Entry entry;
  bool smooth;  ///< works with forces (smooth) or with impulses (non-smooth)
  std::function<std::unique_ptr<Scheme>()> make;
};

inline const std::vector<SchemeEntry>& all_schemes() {
  static const std::vector<SchemeEntry> list{
      {{"velocity-verlet", "kick, drift, kick: second order", {}, {}, "Swope et al. 1982"},
       true,
       [] { return std::make_unique<VelocityVerlet>(); }},
      {{"symplectic-euler", "kick, drift: first order, cheapest", {}, {}, "Vesely 1994"},
       true,
       [] { return std::make_unique<SymplecticEuler>(); }},
      {{"moreau-jean", "impulses at the middle configuration, theta = 1/2", {}, {}, "Moreau 1988, Jean 1999"},
       false,
       [] { return std::make_unique<MoreauJean>(); }},
  };
  return list;
}

}  // namespace epafi
