/// @file contact_tile.h  Contacts on their way through the passes of a law (tile_passes.h), n at a time, and their
/// springs: the formulas of laws/smooth/spring.h.
#pragma once
#include "laws/smooth/fused/sphere_lanes.h"
#include "laws/smooth/spring.h"

namespace epafi {

/// Contacts in the order in which they act. Lanes behind the last one repeat it and add nothing.
template <int n>
struct ContactTile {
  using V = typename LanesOf<n>::Real;
  using V3 = VectorsOf<V>;
  static constexpr std::size_t most = 32, size = most / n;
  static constexpr std::size_t room = most + 16;  ///< a look at eight pairs of spheres may write that far
  std::size_t count = 0, groups = 0;              ///< of contacts, of groups that hold them
  alignas(64) double x[room], y[room], z[room];   ///< normal from A to B; of half-spaces: into the wall
  alignas(64) double overlap[room];               ///< [m]
  std::uint32_t row[room];                        ///< pair of materials, where there are several
  struct Group {
    V approach, middle;  ///< velocity at the detection and in the middle of the step [m/s]
    V inverse_mass, radius;
    V area;                    ///< where the law reads it [m^2]
    V3 slip;                   ///< velocity, in the middle of the step [m/s]; of rolling springs [rad/s]
    V twist;                   ///< about the normal in the step [rad]
    V force;                   ///< [N]
    V normal_stiffness, grip;  ///< [N/m]; what friction slides at, over mu [N]
    V stiffness;               ///< of the spring [N/m]
    V limit;                   ///< of its load [N]
    V compliance;              ///< the old one until it is scaled [m/N]
    V square;                  ///< of its load [N^2]
    V before;                  ///< the same as it comes into the step
    V energy;                  ///< twice that of all springs then [J]
    V shrink;                  ///< old compliance times stiffness
    V3 start, load;            ///< at the start of the step, and now [N]
    // what LaneTotals sums
    V elastic, viscous, late, lost, twice_stored, twice_slipped;
    // of spheres
    V lever;               ///< distance over sum of radii
    V smaller;             ///< radius of the pair [m]
    V radius_a, radius_b;  ///< where dashpots or rolling read them; 0 of a wall [m]
    V3 nearer;             ///< velocity of A against B at the detection [m/s]
    V3 turning;            ///< spin of B against A in the middle of the step [rad/s]
    V virial_x, virial_y, virial_z;
  };
  Group group[size];
  bool slides[size];  ///< some spring of the group is at its limit

  EPAFI_LANES V column(const double* c, std::size_t g) const {
    V out;
    std::memcpy(&out, __builtin_assume_aligned(c + g * n, sizeof out), sizeof out);
    return out;
  }
  EPAFI_LANES V3 normal(std::size_t g) const { return {column(x, g), column(y, g), column(z, g)}; }
  template <std::size_t many, class T>
  EPAFI_LANES static void copy(T* column, std::size_t from, std::size_t to) {
    std::memcpy(column + to, column + from, many * sizeof(T));
  }
  /// Contacts once more, before they are in a group.
  template <std::size_t many = 1>
  EPAFI_LANES void copy(std::size_t from, std::size_t to) {
    for (double* column : {x, y, z, overlap}) copy<many>(column, from, to);
  }
  /// Contact k counts nothing: another process counts it.
  EPAFI_LANES void leave_out(std::size_t k) {
    Group& c = group[k / n];
    c.elastic[k % n] = c.viscous[k % n] = c.late[k % n] = c.lost[k % n] = 0.0;
    c.energy[k % n] = c.twice_stored[k % n] = c.twice_slipped[k % n] = 0.0;
    c.virial_x[k % n] = c.virial_y[k % n] = c.virial_z[k % n] = 0.0;
  }
  /// No friction.
  EPAFI_LANES void rest_springs() {
    for (std::size_t g = 0; g < groups; ++g) {
      group[g].load = V3{};
      group[g].energy = group[g].twice_stored = group[g].twice_slipped = V{};
    }
  }
  /// Lanes of the last group that hold a contact; all those of others do.
  EPAFI_LANES MaskOf<V> used() const {
    MaskOf<V> lane{};
    for (std::size_t l = 0; l < n; ++l) lane[l] = (groups - 1) * n + l < count ? -1 : 0;
    return lane;
  }
};

template <int n>
EPAFI_LANES typename LanesOf<n>::Real filled(double x) {
  return typename LanesOf<n>::Real{} + x;
}

template <LaneVector V>
EPAFI_LANES VectorsOf<V> in_plane(const VectorsOf<V>& x, const VectorsOf<V>& normal) {
  return x - x.dot(normal) * normal;
}

/// laws/smooth/spring.h: the old load turns with the plane, shrinks with the stiffness, follows the slip and stays
/// below the limit. Remembered beside it is 1/stiffness: one division serves the energy now and, in the next step, the
/// energy before and the shrinking. springs: of the tile.
template <int n>
EPAFI_LANES void turn_springs(ContactTile<n>& t, std::size_t g, const TileSpring* springs) {
  using V = typename LanesOf<n>::Real;
  const VectorsOf<V> normal = t.normal(g);
  VectorsOf<V> old;
  V compliance;
  read_columns([&](int l) EPAFI_INLINED { return row<n>(springs[g * n + static_cast<std::size_t>(l)].load); }, old.x,
               old.y, old.z, compliance);
  const VectorsOf<V> load = old + t.group[g].twist * normal.cross(old);
  t.group[g].start = load - normal.dot(load) * normal;
  t.group[g].before = old.dot(old);
  t.group[g].square = t.group[g].start.dot(t.group[g].start);
  t.group[g].energy = t.group[g].before * compliance;
  t.group[g].compliance = compliance;
}

/// The turned load has its old length, and 1/stiffness: by one division. Without stiffness it becomes 1e100, of no
/// load.
template <int n>
EPAFI_LANES void scale_springs(ContactTile<n>& t, std::size_t g) {
  using V = typename LanesOf<n>::Real;
  const V after = t.group[g].square, stiffness = t.group[g].stiffness;
  const V some = at_least<n>(after, 1e-200), k = at_least<n>(stiffness, 1e-100);  // no division by 0
  const V both = 1.0 / (some * k);
  t.group[g].start = sqrt(t.group[g].before * (k * both)) * t.group[g].start;
  t.group[g].shrink = t.group[g].compliance * stiffness;
  t.group[g].compliance = some * both;
}

template <int n>
EPAFI_LANES void stretch_springs(ContactTile<n>& t, std::size_t g, double dt) {
  using V = typename LanesOf<n>::Real;
  const V shrink = t.group[g].shrink;  // below 1 where the contact has become softer; a new one has no load
  t.group[g].load = at_most<n>(shrink, 1.0) * t.group[g].start + (dt * t.group[g].stiffness) * t.group[g].slip;
  t.group[g].square = t.group[g].load.dot(t.group[g].load);
  t.slides[g] = less_bits<n>(t.group[g].limit * t.group[g].limit, t.group[g].square) != 0;
}

template <int n>
EPAFI_LANES void slide(ContactTile<n>& t, std::size_t g) {
  using V = typename LanesOf<n>::Real;
  typename ContactTile<n>::Group& c = t.group[g];
  const V part = c.limit / sqrt(at_least<n>(c.square, 1e-300));  // 1 or more where a spring holds
  c.load = at_most<n>(part, 1.0) * c.load;
  c.square = c.load.dot(c.load);
}

/// Group after group, then finish_pull. Roots and divisions of one group wait beside the turn of the next one.
template <int n>
EPAFI_LANES void pull(ContactTile<n>& t, std::size_t g, const TileSpring* springs, double dt) {
  turn_springs<n>(t, g, springs);
  if (g > 0) scale_springs<n>(t, g - 1);
  if (g > 1) stretch_springs<n>(t, g - 2, dt);
}
template <int n>
EPAFI_LANES void finish_pull(ContactTile<n>& t, double dt) {
  scale_springs<n>(t, t.groups - 1);
  for (std::size_t g = t.groups - std::min<std::size_t>(t.groups, 2); g < t.groups; ++g) stretch_springs<n>(t, g, dt);
  for (std::size_t g = 0; g < t.groups; ++g)
    if (t.slides[g]) slide<n>(t, g);
}

/// What the springs are worth now, and what they remember where time has passed: to[0] and so on of the tile.
template <int n>
EPAFI_LANES void settle_springs(ContactTile<n>& t, std::size_t g, TileSpring* to, double dt) {
  using V = typename LanesOf<n>::Real;
  typename ContactTile<n>::Group& c = t.group[g];
  const V energy = c.square * c.compliance;
  c.twice_stored = energy;
  c.twice_slipped = dt * (c.start + c.load).dot(c.slip) - (energy - c.energy);  // work less growth
  if (!(dt > 0.0)) return;
  RowOf<n> rows[n];
  write_rows(c.load.x, c.load.y, c.load.z, c.compliance, rows);
  [&]<std::size_t... l>(std::index_sequence<l...>) EPAFI_INLINED {  // of a loop GCC 12 makes a copy through memory
    (store<n>(to[g * n + l].load, rows[l]), ...);
  }
  (std::make_index_sequence<n>{});
}

/// Sums in the order of the contacts that touch.
template <int n>
struct LaneTotals {
  LaneSum<n> elastic, viscous;             ///< of the normal parts [J], [W]
  LaneSum<n> late;                         ///< as DashpotLoss::late [J]
  LaneSum<n> twice_stored, twice_slipped;  ///< of the springs [J]
  LaneSum<n> lost;                         ///< to plastic deformation or adhesion [J]
  std::size_t touching = 0;
};

/// Adds what the contacts of a tile come to. At its end and not in every loop: masks and sums in memory were 25
/// instructions of 560 for four contacts.
template <int n>
EPAFI_LANES void add_up(ContactTile<n>& t, LaneSum<n>& sum, typename LanesOf<n>::Real ContactTile<n>::Group::*x) {
  using V = typename LanesOf<n>::Real;
  constexpr std::size_t parts = LaneSum<n>::parts;
  const std::size_t whole = (t.groups + parts - 1) / parts * parts;
  if (t.count < ContactTile<n>::most) {
    V& last = t.group[t.groups - 1].*x;
    last = keep(t.used(), last);
    for (std::size_t g = t.groups; g < whole; ++g) t.group[g].*x = V{};
  }
  sum.add(whole, [&](std::size_t g) EPAFI_INLINED { return t.group[g].*x; });
}
template <int n, bool remembers>
EPAFI_LANES void total_up(ContactTile<n>& t, LaneTotals<n>& total, bool tells_energy, bool damps, bool loses) {
  using Group = typename ContactTile<n>::Group;
  if (tells_energy) {
    add_up<n>(t, total.elastic, &Group::elastic);
    if constexpr (remembers) add_up<n>(t, total.twice_stored, &Group::twice_stored);
  }
  add_up<n>(t, total.viscous, &Group::viscous);
  if (damps) add_up<n>(t, total.late, &Group::late);
  if constexpr (remembers) add_up<n>(t, total.twice_slipped, &Group::twice_slipped);
  if (loses) add_up<n>(t, total.lost, &Group::lost);
  total.touching += t.count;
}

}  // namespace epafi
