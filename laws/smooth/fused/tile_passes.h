/// @file tile_passes.h  Laws as passes over a tile of contacts: each is compiled once for each width and called once
/// for each tile by pointer, so that normal laws, friction and rolling add up and do not multiply.
///   normal      reads overlap, approach, mass and radius; writes force, stiffness, grip and what is lost
///   tangential  reads stiffness, grip, slip and twist; writes the load
///   rolling     damps friction, resists rolling
#pragma once
#include "laws/smooth/fused/sphere_tile.h"
#include "laws/smooth/rolling.h"
#include "laws/smooth/smooth_law.h"

namespace epafi {

/// Every pass.
struct PassCall {
  void* tile;           ///< SphereTile<n>
  const PairRow* rows;  ///< by SphereTile::row
  bool one_row;         ///< all contacts of the tile have the first
  double dt;            ///< [s]
};
struct NormalCall : PassCall {
  const double* before;  ///< history of the tile's contacts
  double* now;
  double lag;  ///< from the middle of the step to the detection [s]; 0: no law damps
  bool tells_energy;
  bool locates;        ///< start and end of contacts count for the part of the step that they take
  double ratio = 1.0;  ///< as DamperStep::before
};
struct TangentialCall : PassCall {
  const SphereSpring* before;
  SphereSpring* now;
  const PackedBristles* bristles_before;
  PackedBristles* bristles_now;  ///< of the tile; where no time passes, by SphereTile::spring
};
struct RollingCall : PassCall {
  const SphereSpring* before;
  SphereSpring* now;
  AnyRolling::Type type;
  SphereBlocks::Block* block;
  const SphereArrays* arrays;
  SphereSprings::Places at;
  bool wall, across, periodic;
};

struct Passes {
  void (*normal)(const NormalCall&) = nullptr;
  void (*tangential)(const TangentialCall&) = nullptr;  ///< null: no friction
  void (*rolling)(const RollingCall&) = nullptr;        ///< null: neither rolling friction nor dashpots
  AnyRolling::Type type = AnyRolling::Type::spring;
  SphereNeeds needs;
  bool locates = false;
};

/// A number each of a law's parameters; of the row, one behind the other.
template <class P, class Real>
EPAFI_LANES P parameters_from(const Real* numbers) {
  return [&]<std::size_t... k>(std::index_sequence<k...>) EPAFI_INLINED { return P{numbers[k]...}; }
  (std::make_index_sequence<sizeof(P) / sizeof(Real)>{});
}

/// f(g, p) for all groups; p[0] and so on: the row of `part` of every contact.
template <int n, class F>
EPAFI_LANES void each_group(const SphereTile<n>& t, const PassCall& call, Lanes PairRow::*part, const F& f) {
  using V = typename LanesOf<n>::Real;
  V p[PairRow::most];
  if (call.one_row) {  // a loop of its own: with a question in the loop passes took a tenth longer
    for (std::size_t k = 0; k < PairRow::most; ++k) p[k] = V{} + (call.rows[0].*part)[k];
    for (std::size_t g = 0; g < t.groups; ++g) f(g, p);
    return;
  }
  for (std::size_t g = 0; g < t.groups; ++g) {
    const std::uint32_t* at = t.row + g * n;
    read_columns([&](int l) EPAFI_INLINED { return row<n>(call.rows[at[l]].*part); }, p[0], p[1], p[2], p[3]);
    f(g, p);
  }
}

}  // namespace epafi
