/// @file sphere_tile.h  Contacts of spheres on their way through the loops of laws/smooth/fused/sphere_kernel.h, what
/// these read and write, and their springs: the formulas of laws/smooth/spring.h.
#pragma once
#include "laws/contact_law.h"
#include "laws/smooth/fused/sphere_blocks.h"
#include "laws/smooth/fused/sphere_lanes.h"
#include "laws/smooth/fused/virial_terms.h"

namespace epafi {

/// What the pairs of a block read and write.
struct SphereArrays {
  const SpherePlane* planes;
  const BodyState* states;
  std::uintptr_t sums;  ///< address of slot 0, were it there: those of the block are
  double dt, lag;       ///< of the step; from its middle to the time of the predicted velocities [s]
  double ratio;         ///< as DamperStep::before
  bool damped;
  bool tells_energy;  ///< the stored energy is needed
  const struct Passes* passes = nullptr;
  const struct PairRow* rows = nullptr;     ///< by pair of materials
  const std::uint16_t* material = nullptr;  ///< by place; null: all spheres are of `own`
  std::uint32_t materials = 1, own = 0;
  const std::uint8_t* owner = nullptr;  ///< as World::owner, by place; null: all contacts count
  double reach = 0.0;                   ///< contacts hold so far beyond touch [m]
  Lanes cell_size{}, strain_rate{};     ///< of a periodic cell [m], [1/s]; fourth 0
  SpherePlace nowhere{};                ///< of a sum that is never read: for lanes after the last contact
  // with dashpots or rolling: spins and in the fourth 1/moment of inertia, by place; with rolling, as sums
  const Lanes* late_spins = nullptr;
  std::uintptr_t moments = 0;
  const Vec3* offsets = nullptr;  ///< by place of balls, from the centres of their bodies [m]; null: there are none
  std::size_t balls = 0;

  /// As World::counts; requires `owner`.
  bool counts(const SpherePlaces& pair) const {
    const std::uint8_t of_a = owner[pair.a.slot()];
    return (of_a == World::everywhere ? owner[pair.b.slot()] : of_a) == World::here;
  }
  EPAFI_LANES const BodyState& state(SpherePlace p) const {
    return *reinterpret_cast<const BodyState*>(reinterpret_cast<const char*>(states) +
                                               sizeof(BodyState) / SpherePlace::unit * std::size_t{p.offset});
  }
  /// Contacts are shown after this step.
  bool tells_loads() const { return tells_energy || owner != nullptr; }
  EPAFI_LANES SphereSum& sum(SpherePlace p) const {
    return *reinterpret_cast<SphereSum*>(sums + p.offset);  // NOLINT: an address
  }
  EPAFI_LANES const Lanes& late_spin(SpherePlace p) const {
    return *reinterpret_cast<const Lanes*>(reinterpret_cast<const char*>(late_spins) +
                                           p.offset / (SpherePlace::unit / sizeof(Lanes)));
  }
  EPAFI_LANES Lanes& moment(SpherePlace p) const {
    return *reinterpret_cast<Lanes*>(moments + p.offset / (SpherePlace::unit / sizeof(Lanes)));  // NOLINT: an address
  }
};

/// What a run found: sums in the order of the contacts that touch.
template <int n>
struct SphereTotals {
  LaneSum<n> elastic, viscous;                              ///< of the normal parts [J], [W]
  LaneSum<n> late;                                          ///< as DashpotLoss::late [J]
  LaneSum<n> twice_stored, twice_slipped;                   ///< of the springs [J]
  VirialTerms virial;                                       ///< with a periodic cell [N m]
  LaneSum<n> lost;                                          ///< to plastic deformation or adhesion [J]
  typename LanesOf<n>::Real deepest{}, deepest_relative{};  ///< overlap [m], over the smaller radius
  double released = 0.0;                                    ///< energy of the springs of contacts that opened [J]
  std::size_t touching = 0;
};

/// Contacts on their way through the loops. Lanes behind the last contact repeat it and add nothing.
template <int n>
struct SphereTile {
  using V = typename LanesOf<n>::Real;
  using V3 = VectorsOf<V>;
  static constexpr std::size_t most = 32, size = most / n;
  static constexpr std::size_t room = most + 16;  ///< a look at eight pairs may write that far
  std::size_t count = 0, groups = 0;              ///< of contacts, of groups that hold them
  alignas(64) double x[room], y[room], z[room];   ///< normal from A to B; of walls: into the wall
  alignas(64) double overlap[room];               ///< [m]
  alignas(64) double curvature[room];             ///< 1/sum of radii [1/m]; not of walls
  alignas(64) double distance[room];              ///< of centres, in a periodic cell [m]
  alignas(64) SpherePlaces bodies[room];
  alignas(64) std::uint32_t pair[room];  ///< in a periodic cell, where a pair has its image
  std::uint32_t row[room];               ///< pair of materials, where there are several
  std::uint32_t spring[room];            ///< place it is read from; not known where they are in a row
  bool in_row = true;                    ///< the springs lie one behind the other
  struct Group {
    V lever;             ///< distance over sum of radii
    V approach, middle;  ///< velocity at the detection and in the middle of the step [m/s]
    V inverse_mass, radius;
    V smaller;  ///< radius of the pair [m]
    // where dashpots or rolling read them:
    V radius_a, radius_b;      ///< 0 of a wall [m]
    V3 nearer;                 ///< velocity of A against B at the detection, without the flow of a cell [m/s]
    V3 turning;                ///< spin of B against A in the middle of the step [rad/s]
    V3 slip;                   ///< velocity, in the middle of the step [m/s]; of rolling springs [rad/s]
    V twist;                   ///< about the normal in the step [rad]
    V force;                   ///< [N]
    V normal_stiffness, grip;  ///< [N/m]; what friction slides at, over mu [N]
    V stiffness;               ///< of the spring [N/m]
    V limit;                   ///< of its load [N]
    V compliance;              ///< the old one until it is scaled [m/N]
    V square;                  ///< of its load [N^2]
    V before;                  ///< the same as it comes into the step
    V energy;                  ///< twice its energy then [J]
    V shrink;                  ///< old compliance times stiffness
    V3 start, load;            ///< at the start of the step, and now [N]
    // what SphereTotals sums
    V elastic, viscous, late, lost, twice_stored, twice_slipped;
    V virial_x, virial_y, virial_z;
  };
  Group group[size];
  bool slides[size];  ///< some spring of the group is at its limit

  EPAFI_LANES V column(const double* c, std::size_t g) const {
    V out;
    std::memcpy(&out, __builtin_assume_aligned(c + g * n, sizeof out), sizeof out);
    return out;
  }
  /// By a column's offset from here contact `at` stands in it. By SSE2, where each column is written by two addresses,
  /// one register for all columns: the compiler took seven and had no room for them (2 % of the stage).
  EPAFI_LANES char* row_from(std::size_t at) {
    char* row = reinterpret_cast<char*>(this) + at * sizeof(double);
    if constexpr (n == 2) __asm__("" : "+r"(row));
    return row;
  }
  EPAFI_LANES void set_normal(const Vec3& all) {
    std::fill_n(x, room, all.x());
    std::fill_n(y, room, all.y());
    std::fill_n(z, room, all.z());
  }
  EPAFI_LANES V3 normal(std::size_t g) const { return {column(x, g), column(y, g), column(z, g)}; }
  /// A contact once more, before it is in a group.
  EPAFI_LANES void copy(std::size_t from, std::size_t to) {
    x[to] = x[from];
    y[to] = y[from];
    z[to] = z[from];
    overlap[to] = overlap[from];
    curvature[to] = curvature[from];
    distance[to] = distance[from];
    bodies[to] = bodies[from];
    pair[to] = pair[from];
    spring[to] = spring[from];
  }
  /// The springs of the contacts from `begin` on: of `eight` pairs those that touch `now` did so `before` or have none
  /// yet; read: place of the first one of these pairs.
  EPAFI_LANES void find_springs(std::size_t begin, unsigned before, unsigned now, std::uint32_t read) {
    if (before == now && in_row) [[likely]]
      return;
    if (in_row) name_row(begin, read);
    for (unsigned bits = now; bits != 0; bits &= bits - 1u, ++begin) {
      const unsigned bit = bits & -bits;
      spring[begin] = (before & bit) != 0 ? read + bit_places.count[before & (bit - 1u)] : SphereSprings::unloaded;
    }
  }
  /// Sets the springs of the first contacts to a contiguous row that ends before place `end`.
  EPAFI_LANES void name_row(std::size_t size, std::uint32_t end) {
    for (std::size_t k = 0; k < size; ++k) spring[k] = end - static_cast<std::uint32_t>(size - k);
    in_row = false;
  }
  EPAFI_LANES void find_row(std::uint32_t end) {
    if (in_row) return;
    in_row = true;
    for (std::size_t k = 0; k < count; ++k) in_row = in_row && spring[k] == end - static_cast<std::uint32_t>(count - k);
  }
  /// What the contacts remember in a column, one behind the other; row: place of the first where they are. `gathered`
  /// holds those that are not, and what lanes behind the last contact read.
  template <class T>
  EPAFI_LANES const T* gather(const T* column, std::uint32_t row, T* gathered) const {
    if (in_row && groups * n == count) [[likely]]
      return column + row;
    gather_apart(column, row, gathered);
    return gathered;
  }
  template <class T>
  [[gnu::noinline]] void gather_apart(const T* column, std::uint32_t row, T* gathered) const {
    for (std::size_t k = 0; k < count; ++k)
      gathered[k] = column[in_row ? row + static_cast<std::uint32_t>(k) : spring[k]];
    std::fill(gathered + count, gathered + groups * n, gathered[count - 1]);
  }
  /// No friction.
  EPAFI_LANES void rest_springs() {
    for (std::size_t g = 0; g < groups; ++g) {
      group[g].load = V3{};
      group[g].twice_stored = group[g].twice_slipped = V{};
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

/// laws/smooth/spring.h: the old load turns with the plane, shrinks with the stiffness, follows the slip and stays
/// below the limit. Remembered beside it is 1/stiffness: one division serves the energy now and, in the next step, the
/// energy before and the shrinking. springs: of the tile.
template <int n>
EPAFI_LANES void turn_springs(SphereTile<n>& t, std::size_t g, const SphereSpring* springs) {
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
EPAFI_LANES void scale_springs(SphereTile<n>& t, std::size_t g) {
  using V = typename LanesOf<n>::Real;
  const V after = t.group[g].square, stiffness = t.group[g].stiffness;
  const V some = at_least<n>(after, 1e-200), k = at_least<n>(stiffness, 1e-100);  // no division by 0
  const V both = 1.0 / (some * k);
  t.group[g].start = sqrt(t.group[g].before * (k * both)) * t.group[g].start;
  t.group[g].shrink = t.group[g].compliance * stiffness;
  t.group[g].compliance = some * both;
}

template <int n>
EPAFI_LANES void stretch_springs(SphereTile<n>& t, std::size_t g, double dt) {
  using V = typename LanesOf<n>::Real;
  const V shrink = t.group[g].shrink;  // below 1 where the contact has become softer; a new one has no load
  t.group[g].load = at_most<n>(shrink, 1.0) * t.group[g].start + (dt * t.group[g].stiffness) * t.group[g].slip;
  t.group[g].square = t.group[g].load.dot(t.group[g].load);
  t.slides[g] = less_bits<n>(t.group[g].limit * t.group[g].limit, t.group[g].square) != 0;
}

template <int n>
EPAFI_LANES void slide(SphereTile<n>& t, std::size_t g) {
  using V = typename LanesOf<n>::Real;
  typename SphereTile<n>::Group& c = t.group[g];
  const V part = c.limit / sqrt(at_least<n>(c.square, 1e-300));  // 1 or more where a spring holds
  c.load = at_most<n>(part, 1.0) * c.load;
  c.square = c.load.dot(c.load);
}

/// Group after group, then finish_pull. Roots and divisions of one group wait beside the turn of the next one.
template <int n>
EPAFI_LANES void pull(SphereTile<n>& t, std::size_t g, const SphereSpring* springs, double dt) {
  turn_springs<n>(t, g, springs);
  if (g > 0) scale_springs<n>(t, g - 1);
  if (g > 1) stretch_springs<n>(t, g - 2, dt);
}
template <int n>
EPAFI_LANES void finish_pull(SphereTile<n>& t, double dt) {
  scale_springs<n>(t, t.groups - 1);
  for (std::size_t g = t.groups - std::min<std::size_t>(t.groups, 2); g < t.groups; ++g) stretch_springs<n>(t, g, dt);
  for (std::size_t g = 0; g < t.groups; ++g)
    if (t.slides[g]) slide<n>(t, g);
}

/// What the springs are worth now, and what they remember where time has passed: to[0] and so on of the tile.
template <int n>
EPAFI_LANES void settle_springs(SphereTile<n>& t, std::size_t g, SphereSpring* to, double dt) {
  using V = typename LanesOf<n>::Real;
  typename SphereTile<n>::Group& c = t.group[g];
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

/// Divides only where an overlap may exceed the largest so far; with some slack, so that the result does not depend on
/// the order. Lanes behind the last contact repeat it and change nothing.
template <int n>
EPAFI_LANES void note_depths(const SphereTile<n>& t, SphereTotals<n>& total) {
  using V = typename LanesOf<n>::Real;
  constexpr double slack = 1.0 - 1e-12;
  V deepest = total.deepest, relative = total.deepest_relative;
  for (std::size_t g = 0; g < t.groups; ++g) {
    const V overlap = t.column(t.overlap, g), smaller = t.group[g].smaller;
    deepest = max(deepest, overlap);
    if (less_bits<n>(slack * relative * smaller, overlap) != 0) [[unlikely]]
      relative = max(relative, overlap / smaller);
  }
  total.deepest = deepest;
  total.deepest_relative = relative;
}

/// Contacts that another process counts come to nothing here, and nothing is added to what they do to a held ball.
template <int n>
[[gnu::noinline]] void leave_out(SphereTile<n>& t, SphereTotals<n>& total, const SphereArrays& with, bool wall) {
  const auto is_held = [&](SpherePlace p) { return with.owner[p.slot()] == World::everywhere; };
  for (std::size_t k = 0; k < t.count; ++k) {
    if (with.counts(t.bodies[k])) continue;
    auto& c = t.group[k / n];
    const int lane = static_cast<int>(k % n);
    if (!wall && (is_held(t.bodies[k].a) || is_held(t.bodies[k].b)))
      c.force[lane] = c.load.x[lane] = c.load.y[lane] = c.load.z[lane] = 0.0;
    c.elastic[lane] = c.viscous[lane] = c.late[lane] = c.lost[lane] = c.twice_stored[lane] = c.twice_slipped[lane] =
        0.0;
    --total.touching;
  }
}

/// The same of their virials, which are known last.
template <int n>
[[gnu::noinline]] void leave_out_virials(SphereTile<n>& t, const SphereArrays& with) {
  for (std::size_t k = 0; k < t.count; ++k) {
    if (with.counts(t.bodies[k])) continue;
    auto& c = t.group[k / n];
    const int lane = static_cast<int>(k % n);
    c.virial_x[lane] = c.virial_y[lane] = c.virial_z[lane] = 0.0;
  }
}

/// Adds what the contacts of a tile come to. At its end and not in every loop: masks and sums in memory were 25
/// instructions of 560 for four contacts.
template <int n, bool remembers, bool periodic>
EPAFI_LANES void total_up(SphereTile<n>& t, SphereTotals<n>& total, bool tells_energy, bool damps, bool loses) {
  using V = typename LanesOf<n>::Real;
  using Group = typename SphereTile<n>::Group;
  constexpr std::size_t parts = LaneSum<n>::parts;
  const std::size_t whole = (t.groups + parts - 1) / parts * parts;
  const auto add = [&](LaneSum<n>& sum, V Group::*x) EPAFI_INLINED {
    if (t.count < SphereTile<n>::most) {
      V& last = t.group[t.groups - 1].*x;
      last = keep(t.used(), last);
      for (std::size_t g = t.groups; g < whole; ++g) t.group[g].*x = V{};
    }
    sum.add(whole, [&](std::size_t g) EPAFI_INLINED { return t.group[g].*x; });
  };
  if (tells_energy) {
    add(total.elastic, &Group::elastic);
    if constexpr (remembers) add(total.twice_stored, &Group::twice_stored);
  }
  add(total.viscous, &Group::viscous);
  if (damps) add(total.late, &Group::late);
  if constexpr (remembers) add(total.twice_slipped, &Group::twice_slipped);
  if (loses) add(total.lost, &Group::lost);
  if constexpr (periodic) {
    const auto put = [&](std::size_t axis, V Group::*x) EPAFI_INLINED {
      double* const to = total.virial.next(axis);
      for (std::size_t g = 0; g < t.groups; ++g) std::memcpy(to + g * n, &(t.group[g].*x), sizeof(V));
    };
    put(0, &Group::virial_x);
    put(1, &Group::virial_y);
    put(2, &Group::virial_z);
    total.virial.advance(t.count);
  }
  total.touching += t.count;
}

}  // namespace epafi
