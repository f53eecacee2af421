/// @file tile_passes.h  Laws as passes over a tile of contacts: each is compiled once for each width and called once
/// for each tile by pointer, so that normal laws, friction and rolling add up and do not multiply.
///   normal      reads overlap, approach, mass and radius; writes force, stiffness, grip and what is lost
///   tangential  reads stiffness, grip, slip and twist; writes the load
///   rolling     damps friction, resists rolling
#pragma once
#include "laws/smooth/passes/contact_tile.h"
#include "laws/smooth/rolling.h"
#include "laws/smooth/smooth_law.h"

namespace epafi {

/// The parts of a law as functions over tiles, for the widest lanes of now.
struct Passes {
  void (*normal)(const NormalCall&) = nullptr;
  void (*lanes)(const NormalCall&) = nullptr;           ///< the same without located edges; null: contact by contact
  void (*tangential)(const TangentialCall&) = nullptr;  ///< null: no friction
  void (*rolling)(const RollingCall&) = nullptr;        ///< null: neither rolling friction nor dashpots
  const SmoothLaw* law = nullptr;
  NormalResponse (*one)(const double*, const ContactKinematics&, const double*, double*, const double*) = nullptr;
  SphereNeeds needs;
};

/// Every pass.
struct PassCall {
  void* tile;  ///< ContactTile<n>
  const Passes* passes;
  const PairRow* rows;  ///< by ContactTile::row
  bool one_row;         ///< all contacts of the tile have the first
  double dt;            ///< [s]

  const PairRow& row(const std::uint32_t* of_contact) const { return rows[one_row ? 0 : *of_contact]; }
};
struct NormalCall : PassCall {
  const double* before;  ///< what the tile's contacts remember, one behind the other
  double* now;
  const double* push_before;  ///< forces of their dashpots [N]; null: no law damps
  double* push;
  double lag;  ///< from the middle of the step to the detection [s]; 0: no law damps
  bool tells_energy;
  double ratio = 1.0;  ///< as DamperStep::before
};
struct TangentialCall : PassCall {
  const void* before;  ///< of the tile: TileSpring, or the numbers of a law that is evaluated contact by contact
  void* now;           ///< springs: written where time passes
};
/// Motion of the contacts of a tile against dashpots and rolling, and their loads.
template <int n>
struct TileRolling {
  using V = typename LanesOf<n>::Real;
  using V3 = VectorsOf<V>;
  static constexpr std::size_t size = ContactTile<n>::size;
  V3 slip[size], spin[size];        ///< velocities at the time of the detection [m/s], [rad/s]
  V3 turning[size];                 ///< against each other, in the middle of the step [rad/s]
  V slip_mobility[size];            ///< [1/kg]
  V inertia[size];                  ///< about the contact [kg m^2]
  V inverse_inertia[size];          ///< sum of those about the centres [1/(kg m^2)]
  V dashpot[size];                  ///< against rolling [N m s]
  V3 friction[size], moment[size];  ///< on A [N], [N m]
  V stored[size], slipped[size];    ///< twice those of the friction springs [J]
  V before[size];                   ///< twice their energy as they come into the step [J]
};
struct RollingCall : PassCall {
  const TileSpring* before;
  TileSpring* now;
  double lag;
  void* motion;  ///< TileRolling<n>
};

/// A number each of a law's parameters; of the row, one behind the other.
template <class P, class Real>
EPAFI_LANES P parameters_from(const Real* numbers) {
  return [&]<std::size_t... k>(std::index_sequence<k...>) EPAFI_INLINED { return P{numbers[k]...}; }
  (std::make_index_sequence<sizeof(P) / sizeof(Real)>{});
}

/// f(g, p) for all groups; p[0] and so on: the row of `part` of every contact.
template <int n, class F>
EPAFI_LANES void each_group(const ContactTile<n>& t, const PassCall& call, Lanes PairRow::*part, const F& f) {
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
