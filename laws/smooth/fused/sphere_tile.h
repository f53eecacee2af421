/// @file sphere_tile.h  Contacts of spheres on their way through the loops of laws/smooth/fused/sphere_kernel.h, and
/// what these read and write.
#pragma once
#include "laws/smooth/fused/sphere_blocks.h"
#include "laws/smooth/fused/virial_terms.h"
#include "laws/smooth/passes/contact_tile.h"

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
  void (*rolling)(const struct SphereRollingCall&) = nullptr;
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

/// What a run found.
template <int n>
struct SphereTotals : LaneTotals<n> {
  VirialTerms virial;                                       ///< with a periodic cell [N m]
  typename LanesOf<n>::Real deepest{}, deepest_relative{};  ///< overlap [m], over the smaller radius
  double released = 0.0;                                    ///< energy of the springs of contacts that opened [J]
};

template <int n>
struct SphereTile : ContactTile<n> {
  using Base = ContactTile<n>;
  using Base::count, Base::groups, Base::room;
  alignas(64) double curvature[room];  ///< 1/sum of radii [1/m]; not of walls
  alignas(64) double distance[room];   ///< of centres, in a periodic cell [m]
  alignas(64) SpherePlaces bodies[room];
  alignas(64) std::uint32_t pair[room];  ///< in a periodic cell, where a pair has its image
  std::uint32_t spring[room];            ///< place it is read from; not known where they are in a row
  bool in_row = true;                    ///< the springs lie one behind the other

  /// By a column's offset from here contact `at` stands in it. By SSE2, where each column is written by two addresses,
  /// one register for all columns: the compiler took seven and had no room for them (2 % of the stage).
  EPAFI_LANES char* row_from(std::size_t at) {
    char* row = reinterpret_cast<char*>(this) + at * sizeof(double);
    if constexpr (n == 2) __asm__("" : "+r"(row));
    return row;
  }
  EPAFI_LANES std::ptrdiff_t offset_of(const void* column) const {
    return static_cast<const char*>(column) - reinterpret_cast<const char*>(this);
  }
  EPAFI_LANES void set_normal(const Vec3& all) {
    std::fill_n(this->x, room, all.x());
    std::fill_n(this->y, room, all.y());
    std::fill_n(this->z, room, all.z());
  }
  template <std::size_t many = 1>
  EPAFI_LANES void copy(std::size_t from, std::size_t to) {
    Base::template copy<many>(from, to);
    Base::template copy<many>(curvature, from, to);
    Base::template copy<many>(distance, from, to);
    Base::template copy<many>(bodies, from, to);
    Base::template copy<many>(pair, from, to);
    Base::template copy<many>(spring, from, to);
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
};

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
    t.leave_out(k);
    --total.touching;
  }
}

/// The same of their virials, which are known last.
template <int n>
[[gnu::noinline]] void leave_out_virials(SphereTile<n>& t, const SphereArrays& with) {
  for (std::size_t k = 0; k < t.count; ++k)
    if (!with.counts(t.bodies[k])) t.leave_out(k);
}

/// Adds the virials of a tile.
template <int n>
EPAFI_LANES void add_virials(const SphereTile<n>& t, SphereTotals<n>& total) {
  using V = typename LanesOf<n>::Real;
  using Group = typename SphereTile<n>::Group;
  const auto put = [&](std::size_t axis, V Group::*x) EPAFI_INLINED {
    double* const to = total.virial.next(axis);
    for (std::size_t g = 0; g < t.groups; ++g) std::memcpy(to + g * n, &(t.group[g].*x), sizeof(V));
  };
  put(0, &Group::virial_x);
  put(1, &Group::virial_y);
  put(2, &Group::virial_z);
  total.virial.advance(t.count);
}

}  // namespace epafi
