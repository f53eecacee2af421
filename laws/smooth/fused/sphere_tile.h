/// @file sphere_tile.h  Contacts of spheres on their way through the loops of laws/smooth/fused/sphere_kernel.h, what
/// these read and write, and their springs: the formulas of laws/smooth/spring.h.
#pragma once
#include "laws/contact_law.h"
#include "laws/smooth/fused/sphere_blocks.h"
#include "laws/smooth/fused/sphere_lanes.h"

namespace epafi {

/// What the pairs of a block read and write.
struct SphereArrays {
  const SpherePlane* planes;
  const SphereState* states;
  std::uintptr_t sums;  ///< address of slot 0, were it there: those of the block are
  SphereSum* records;
  double dt;
  bool damped;
  Lanes cell_size, strain_rate;  ///< of a periodic cell [m], [1/s]; fourth 0
  // with rolling: spins by slot, then as sums and records
  const Lanes* late_spins = nullptr;
  std::uintptr_t moments = 0;
  Lanes* record_moments = nullptr;

  EPAFI_LANES const SphereState& state(SpherePlace p) const {
    return *reinterpret_cast<const SphereState*>(reinterpret_cast<const char*>(states) +
                                                 sizeof(SphereState) / SpherePlace::unit * std::size_t{p.offset});
  }
  EPAFI_LANES SphereSum& sum(SpherePlace p) const {
    return *reinterpret_cast<SphereSum*>(sums + p.offset);  // NOLINT: an address
  }
  EPAFI_LANES const Lanes& late_spin(SpherePlace p) const { return late_spins[p.offset / SpherePlace::unit]; }
  EPAFI_LANES Lanes& moment(SpherePlace p) const {
    return *reinterpret_cast<Lanes*>(moments + p.offset / (SpherePlace::unit / sizeof(Lanes)));  // NOLINT: an address
  }
};

/// What a run found: sums in the order of the contacts that touch.
template <int n>
struct SphereTotals {
  LaneSum<n> elastic, slipped, viscous;  ///< [J], [J], [W]
  LaneSum<n> virial[3];
  double released = 0.0;  ///< energy of the springs of contacts that opened [J]
  std::size_t touching = 0;
};

inline constexpr LanesOf<2>::Mask pair_masks[2] = {{-1, 0}, {-1, -1}};

/// Contacts on their way through the loops. Lanes behind the last contact repeat it and add nothing.
template <int n>
struct SphereTile {
  using V = typename LanesOf<n>::Real;
  using V3 = VectorsOf<V>;
  static constexpr std::size_t most = 32, size = most / n;
  static constexpr std::size_t room = most + 16;  ///< a look at eight pairs may write that far
  std::size_t count = 0, groups = 0;              ///< of contacts, of groups that hold them
  alignas(64) double x[room], y[room], z[room];   ///< from centre to centre [m]; of walls: x, how far above
  alignas(64) double radii[room];                 ///< sum of both [m]
  alignas(64) SpherePlaces bodies[room];
  alignas(64) std::uint32_t pair[room];
  V lever[size];     ///< distance over sum of radii
  V3 normal[size];   ///< from A to B; of walls: into the wall
  V distance[size];  ///< of centres [m]
  V overlap[size], approach[size], mass[size], radius[size];
  V3 displacement[size];           ///< slip of the step [m]
  V twist[size];                   ///< about the normal in the step [rad]
  V force[size];                   ///< [N]
  V stiffness[size], limit[size];  ///< of the spring [N/m], [N]
  V compliance[size];              ///< the old one until it is scaled [m/N]
  V square[size];                  ///< of the spring's load [N^2]
  // of the spring: load squared, energy [J], old compliance times stiffness
  V before[size], energy[size], shrink[size];
  V3 start[size], load[size];  ///< of the spring, as it comes into the step and now [N]

  EPAFI_LANES V column(const double* c, std::size_t g) const {
    V out;
    std::memcpy(&out, c + g * n, sizeof out);
    return out;
  }
  /// All but the lanes behind the last contact.
  EPAFI_LANES MaskOf<V> used(std::size_t g) const {
    if constexpr (n == 2) return pair_masks[count - g * n > 1];  // SSE2 does not compare such numbers
    MaskOf<V> lane{};
    for (int l = 0; l < n; ++l) lane[l] = l;
    return lane < static_cast<long long>(count - g * n) + MaskOf<V>{};
  }
};

template <int n>
EPAFI_LANES typename LanesOf<n>::Real filled(double x) {
  return typename LanesOf<n>::Real{} + x;
}

/// laws/smooth/spring.h: the old load turns with the plane, shrinks with the stiffness, follows the slip and stays
/// below the limit. Remembered beside it is 1/stiffness: one division serves the energy now and, in the next step, the
/// energy before and the shrinking.
template <int n>
EPAFI_LANES void turn_springs(SphereTile<n>& t, std::size_t g, const SphereSpring* springs) {
  using V = typename LanesOf<n>::Real;
  const std::uint32_t* pair = t.pair + g * n;
  const VectorsOf<V>& normal = t.normal[g];
  VectorsOf<V> old;
  V compliance;
  read_columns([&](int l) EPAFI_INLINED { return row<n>(springs[pair[l]].load); }, old.x, old.y, old.z, compliance);
  const VectorsOf<V> load = old + t.twist[g] * normal.cross(old);
  t.start[g] = load - normal.dot(load) * normal;
  t.before[g] = old.dot(old), t.square[g] = t.start[g].dot(t.start[g]);
  t.energy[g] = 0.5 * t.before[g] * compliance;
  t.compliance[g] = compliance;
}

/// The turned load has its old length, and 1/stiffness: by one division.
template <int n>
EPAFI_LANES void scale_springs(SphereTile<n>& t, std::size_t g) {
  using V = typename LanesOf<n>::Real;
  const V after = t.square[g], stiffness = t.stiffness[g];
  const MaskOf<V> turns = after > filled<n>(1e-200), stiff = stiffness > V{};  // loads below 1e-100 N are none
  const V some = select(turns, after, filled<n>(1.0)), k = select(stiff, stiffness, filled<n>(1.0));
  const V both = 1.0 / (some * k);
  t.start[g] = keep(turns, sqrt(t.before[g] * (k * both))) * t.start[g];
  t.shrink[g] = t.compliance[g] * stiffness;
  t.compliance[g] = keep(stiff, some * both);
}

/// True where some lane slides.
template <int n>
EPAFI_LANES bool stretch_springs(SphereTile<n>& t, std::size_t g) {
  using V = typename LanesOf<n>::Real;
  const V shrink = t.shrink[g];  // below 1 where the contact has become softer; a new one has no load
  t.load[g] = select(shrink < filled<n>(1.0), shrink, filled<n>(1.0)) * t.start[g] + t.stiffness[g] * t.displacement[g];
  t.square[g] = t.load[g].dot(t.load[g]);
  return less_bits<n>(t.limit[g] * t.limit[g], t.square[g]) != 0;
}

template <int n>
EPAFI_LANES void slide(SphereTile<n>& t, std::size_t g) {
  using V = typename LanesOf<n>::Real;
  const V square = t.square[g], limit = t.limit[g];
  const MaskOf<V> slides = square > limit * limit;
  t.load[g] = select(slides, limit / sqrt(select(slides, square, filled<n>(1.0))), filled<n>(1.0)) * t.load[g];
  t.square[g] = t.load[g].dot(t.load[g]);
}

template <int n>
EPAFI_LANES void settle_springs(SphereTile<n>& t, std::size_t g, SphereSpring* springs, bool remember,
                                SphereTotals<n>& total) {
  using V = typename LanesOf<n>::Real;
  const std::uint32_t* pair = t.pair + g * n;
  const V energy = 0.5 * t.square[g] * t.compliance[g];
  const V work = 0.5 * (t.start[g] + t.load[g]).dot(t.displacement[g]);
  const MaskOf<V> used = t.used(g);
  total.elastic.add(g, keep(used, energy));
  total.slipped.add(g, keep(used, work - (energy - t.energy[g])));
  if (!remember) return;
  RowOf<n> rows[n];
  write_rows(t.load[g].x, t.load[g].y, t.load[g].z, t.compliance[g], rows);
  for (int l = 0; l < n; ++l) store<n>(springs[pair[l]].load, rows[l]);
}

/// Behind turn_springs.
template <int n>
EPAFI_LANES void pull(SphereTile<n>& t, SphereSpring* springs, bool remember, SphereTotals<n>& total) {
  bool slides[SphereTile<n>::size];
  for (std::size_t g = 0; g < t.groups; ++g) scale_springs<n>(t, g);
  for (std::size_t g = 0; g < t.groups; ++g) slides[g] = stretch_springs<n>(t, g);
  for (std::size_t g = 0; g < t.groups; ++g)
    if (slides[g]) slide<n>(t, g);
  for (std::size_t g = 0; g < t.groups; ++g) settle_springs<n>(t, g, springs, remember, total);
}

}  // namespace epafi
