/// @file sphere_kernel.h  Contact of spheres, n contacts at a time. A first pass tests all pairs of a run and compacts
/// those that touch into tiles of 32 contacts. Each tile passes short loops for motion, the laws (tile_passes.h) and
/// sums, so that the processor works on several groups at once. The result equals that of the generic loop to rounding
/// (tests/physics/test_fused_spheres.cpp), with the same bits for every n.
#pragma once
#include "laws/smooth/fused/sphere_look.h"
#include "laws/smooth/fused/sphere_rolling.h"

namespace epafi {

/// Radius of the contact, and with friction how fast the surfaces move on each other; opening: velocity along the
/// normal.
template <int n, bool turns, bool wall>
EPAFI_LANES void find_radii(SphereTile<n>& t, std::size_t g, const SphereArrays& with,
                            const VectorsOf<typename LanesOf<n>::Real>& velocity,
                            const typename LanesOf<n>::Real& opening) {
  using V = typename LanesOf<n>::Real;
  const SpherePlaces* bodies = t.bodies + g * n;
  typename SphereTile<n>::Group& c = t.group[g];
  const VectorsOf<V> normal = t.normal(g);
  const V curvature = t.column(t.curvature, g);
  VectorsOf<V> spin_a, spin_b{};
  V radius_a, radius_b{};
  read_columns([&](int l) EPAFI_INLINED { return row<n>(with.state(bodies[l].a).spin); }, spin_a.x, spin_a.y, spin_a.z,
               radius_a);
  if constexpr (!wall) {
    read_columns([&](int l) EPAFI_INLINED { return row<n>(with.state(bodies[l].b).spin); }, spin_b.x, spin_b.y,
                 spin_b.z, radius_b);
    c.radius = radius_a * radius_b * curvature;
    c.smaller = min(radius_a, radius_b);
    c.lever = 1.0 - t.column(t.overlap, g) * curvature;
  } else {
    c.radius = c.smaller = radius_a;
    c.lever = filled<n>(1.0);
  }
  if constexpr (turns) {
    c.twist = 0.5 * with.dt * normal.dot(spin_a + spin_b);
    const VectorsOf<V> turning = (c.lever * radius_a) * spin_a + (c.lever * radius_b) * spin_b;
    c.slip = velocity - opening * normal - turning.cross(normal);
    if (with.late_spins == nullptr) return;
    c.radius_a = radius_a;
    c.radius_b = radius_b;
    c.turning = spin_b - spin_a;
  }
}

/// Relative velocities.
template <int n, bool turns, bool wall, bool periodic>
EPAFI_LANES void find_motion(SphereTile<n>& t, std::size_t g, const SphereBlocks::Block& block,
                             const SphereArrays& with) {
  using V = typename LanesOf<n>::Real;
  const SpherePlaces* bodies = t.bodies + g * n;
  typename SphereTile<n>::Group& c = t.group[g];
  const VectorsOf<V> normal = t.normal(g);
  VectorsOf<V> velocity, later;
  V inverse_mass, none, opening;
  if constexpr (wall) {
    read_columns([&](int l) EPAFI_INLINED { return -flip_fourth(row<n>(with.state(bodies[l].a).velocity)); },
                 velocity.x, velocity.y, velocity.z, inverse_mass);
    read_columns([&](int l) EPAFI_INLINED { return row<n>(with.state(bodies[l].a).predicted); }, later.x, later.y,
                 later.z, none);
    opening = velocity.dot(normal);
    c.approach = later.dot(normal);
  } else {
    const auto flow_of_cell = [&](int l) EPAFI_INLINED {
      const auto apart =
          row<n>(with.state(bodies[l].b).position) - row<n>(with.state(bodies[l].a).position) +
          row<n>(with.cell_size) * row<n>(block.images[t.pair[g * n + static_cast<std::size_t>(l)]].cells);
      return row<n>(with.strain_rate) * apart;
    };
    read_columns(
        [&](int l) EPAFI_INLINED {
          const auto moving = apart<n>(with.state(bodies[l].a).velocity, with.state(bodies[l].b).velocity);
          if constexpr (periodic)
            return moving + flow_of_cell(l);
          else
            return moving;
        },
        velocity.x, velocity.y, velocity.z, inverse_mass);
    opening = velocity.dot(normal);
    c.approach = -opening;
    if (with.damped) {
      read_columns(
          [&](int l) EPAFI_INLINED {
            const auto nearer = row<n>(with.state(bodies[l].a).predicted) - row<n>(with.state(bodies[l].b).predicted);
            if constexpr (periodic)
              return nearer - flow_of_cell(l);
            else
              return nearer;
          },
          later.x, later.y, later.z, none);
      c.approach = later.dot(normal);
    }
  }
  if constexpr (turns)
    if (with.late_spins != nullptr) c.nearer = later;
  c.middle = -opening;
  c.inverse_mass = inverse_mass;
  find_radii<n, turns, wall>(t, g, with, velocity, opening);
}

/// Contribution of a contact to the sum of A, and with reversed force to that of B.
template <int n, bool turns>
struct SumRow {
  using Two = LanesOf<2>::Real;
  RowOf<n> first;
  Two second;
  EPAFI_LANES static Two& second_of(SphereSum& sum) { return reinterpret_cast<Two&>(sum.second); }
  EPAFI_LANES SumRow turned() const { return {turn_three(first), second}; }
  EPAFI_LANES void add_to(SphereSum& sum) const {
    store<n>(sum.first, row<n>(sum.first) + first);
    if constexpr (turns) second_of(sum) += second;
  }
  EPAFI_LANES void write(SphereRecord& to) const {
    std::memcpy(to.first, &first, sizeof to.first);
    std::memcpy(to.second, &second, sizeof to.second);
  }
};
/// All in one register.
template <bool turns>
struct SumRow<8, turns> {
  LanesOf<8>::Real all;
  EPAFI_LANES SumRow turned() const {
    constexpr long long sign = static_cast<long long>(1ull << 63);
    return {reinterpret_cast<LanesOf<8>::Real>(reinterpret_cast<LanesOf<8>::Mask>(all) ^
                                               LanesOf<8>::Mask{sign, sign, sign, 0, 0, 0, 0, 0})};
  }
  EPAFI_LANES void add_to(SphereSum& sum) const { reinterpret_cast<LanesOf<8>::Real&>(sum) += all; }
  EPAFI_LANES void write(SphereRecord& to) const {
    const LanesOf<4>::Real first = __builtin_shufflevector(all, all, 0, 1, 2, 3);
    const LanesOf<2>::Real second = __builtin_shufflevector(all, all, 4, 5);
    std::memcpy(to.first, &first, sizeof to.first);
    std::memcpy(to.second, &second, sizeof to.second);
  }
};

template <int n, bool turns>
EPAFI_LANES void write_sum_rows(const VectorsOf<typename LanesOf<n>::Real>& force,
                                const VectorsOf<typename LanesOf<n>::Real>& pull, SumRow<n, turns>* rows) {
  if constexpr (n == 8) {
    LanesOf<8>::Real all[n];
    write_sixes(force, pull, all);
    for (int l = 0; l < n; ++l) rows[l].all = all[l];
  } else {
    RowOf<n> first[n];
    LanesOf<2>::Real second[n];
    write_rows(force.x, force.y, force.z, pull.x, first);
    write_twos(pull.y, pull.z, second);
    for (int l = 0; l < n; ++l) rows[l] = {first[l], second[l]};
  }
}

/// Adds to the sums; for B in another block to the records of the tile.
template <int n, bool turns, bool wall, bool periodic>
EPAFI_LANES void add_forces(SphereTile<n>& t, std::size_t g, const SphereArrays& with, SphereRecord* records,
                            SpherePlace* record_places) {
  using V = typename LanesOf<n>::Real;
  const VectorsOf<V> normal = t.normal(g), &load = t.group[g].load;
  VectorsOf<V> f = -(t.group[g].force * normal), moment{};
  if constexpr (turns) {
    f = f + load;
    moment = t.group[g].lever * normal.cross(load);
  }
  if constexpr (periodic && !wall) {
    const V arm = t.column(t.distance, g);
    t.group[g].virial_x = arm * normal.x * f.x;
    t.group[g].virial_y = arm * normal.y * f.y;
    t.group[g].virial_z = arm * normal.z * f.z;
  }
  SumRow<n, turns> rows[n];
  write_sum_rows<n, turns>(f, moment, rows);
  const SpherePlaces* bodies = t.bodies + g * n;
  for (int l = 0; l < n; ++l) {  // lane by lane, A and B: the order of a body's sum is not that of groups
    rows[l].add_to(with.sum(bodies[l].a));
    if constexpr (!wall) {
      if (records == nullptr) {
        rows[l].turned().add_to(with.sum(bodies[l].b));
      } else {
        rows[l].turned().write(records[g * n + static_cast<std::size_t>(l)]);
        record_places[g * n + static_cast<std::size_t>(l)] = bodies[l].b;
      }
    }
  }
}

/// A run during the loops. Whether it goes across blocks is tested for each tile: separate loops would be 1 % faster
/// but two fifths of the code.
template <int n, bool turns, bool wall, bool periodic>
struct SphereSweep {
  using Places = SphereSprings::Places;
  static constexpr std::uint32_t eight = SphereBlocks::pairs_per_byte;
  static constexpr std::uint32_t springs_ahead = 96;  ///< three tiles, three quarters of a page

  SphereBlocks::Block& block;
  const SphereBlocks::Run& range;
  const SphereArrays& arrays;
  SphereTotals<n>& total;
  Places& places;  ///< of the block's springs

  /// Processes all pairs: touching ones act, those that opened release their springs.
  template <int lanes>
  EPAFI_LANES void run() const {
    static_assert(lanes == n);
    // Copies: a byte written to `touched` may alias anything, and the compiler would load all of these again every
    // eight pairs (408 -> 402 instructions a sphere, 2 % of the stage).
    const SphereArrays with = arrays;
    const SphereLook<n, wall, periodic> all(block, range, arrays);
    std::uint8_t* const touched = block.touched.data();
    const bool across = !wall && range.across, keeps = with.passes->needs.remembers();
    Places at = places;
    [[maybe_unused]] const TileSpring* springs = block.springs.friction();  // to ask for them: they may move
    [[maybe_unused]] SphereBlocks::Target* target = block.targets.data();
    constexpr std::size_t full = SphereTile<n>::most;
    SphereTile<n> t;
    all.begin(t);
    t.in_row = with.dt > 0.0;  // else each contact of its own: those that opened keep their springs
    const std::size_t end = range.end;
    for (std::size_t k = range.begin; k < end; k += eight) {
      const std::size_t begin = t.count;
      const unsigned before = touched[k / eight], now = all.eight_from(t, k, with, before);
      const std::uint32_t read = at.read;
      if (keeps) {
        t.find_springs(begin, before, now, read);
        at.read += bit_places.count[before];
        if constexpr (turns) ask_for(springs + at.read);
      }
      if (across)
        for (; target->pairs_end <= k + eight; ++target)
          target->records_end = at.record + static_cast<std::uint32_t>(begin) +
                                bit_places.count[now & ((1u << (target->pairs_end - k)) - 1u)];
      if (with.dt > 0.0) {
        if (const unsigned opened = before & ~now; opened != 0) release(k, before, opened, read);
        touched[k / eight] = static_cast<std::uint8_t>(now);
      } else if (!keeps) {
        touched[k / eight] = static_cast<std::uint8_t>(before | now);  // no time passes: what is remembered stays
      }
      if (t.count < full) continue;
      const std::size_t found = t.count;
      if (keeps) {
        keep_unread(t, at, begin, read, with);
        springs = block.springs.friction();
      }
      t.count = full;
      evaluate(t, at, at.read - static_cast<std::uint32_t>(found), with);
      t.count = found - full;
      t.template copy<eight>(full, 0);
      if (with.dt > 0.0) t.find_row(at.read);
    }
    if (keeps) keep_unread(t, at, t.count, at.read, with);
    if (t.count > 0) evaluate(t, at, at.read - static_cast<std::uint32_t>(t.count), with);
    places = at;
  }

 private:
  /// Prefetches springs some tiles ahead, since hardware prefetchers stop at page boundaries.
  EPAFI_LANES static void ask_for(const TileSpring* springs) {
    for (std::uint32_t l = 0; l < eight; l += 2) __builtin_prefetch(springs + springs_ahead + l, 1);
  }
  /// Springs overwrite those of earlier contacts. If too many contacts begin, unread springs move up: those of contacts
  /// from number `next` of the tile on, and from `place` on.
  EPAFI_LANES void keep_unread(SphereTile<n>& t, Places& at, std::size_t next, std::uint32_t place,
                               const SphereArrays& with) const {
    const std::size_t written = std::min((t.count + eight - 1) / eight * eight, SphereTile<n>::most);
    if (at.write + written <= place || !(with.dt > 0.0)) [[likely]]
      return;
    if (t.in_row) t.name_row(t.count, at.read);
    const std::uint32_t by = block.springs.make_room(place);
    for (std::size_t k = next; k < t.count; ++k)
      if (t.spring[k] != SphereSprings::unloaded) t.spring[k] += by;
    at.read += by;
  }

  /// The first contacts of a tile through all loops; `count` of them, at most `most`. row: see SphereTile::gather.
  EPAFI_LANES void evaluate(SphereTile<n>& t, Places& at, std::uint32_t row, const SphereArrays& with) const {
    const Passes& passes = *with.passes;
    t.groups = (t.count + n - 1) / n;
    for (std::size_t k = t.count; k < t.groups * n; ++k) t.copy(t.count - 1, k);
    const bool across = !wall && range.across;
    if (across && block.records.size() < at.record + t.groups * n)
      block.grow_records(at.record + SphereTile<n>::most, passes.needs.rolling);
    for (std::size_t g = 0; g < t.groups; ++g) find_motion<n, turns, wall, periodic>(t, g, block, with);
    note_depths<n>(t, total);
    const PassCall call = choose_rows(t, with);
    answer(t, call, at, row, with);
    if (with.owner != nullptr) [[unlikely]]
      leave_out<n>(t, total, with, wall);
    for (std::size_t k = t.count; k < t.groups * n; ++k) t.bodies[k] = {with.nowhere, with.nowhere};
    SphereRecord* const records = across ? block.records.data() + at.record : nullptr;
    SpherePlace* const record_places = across ? block.record_places.data() + at.record : nullptr;
    for (std::size_t g = 0; g < t.groups; ++g) add_forces<n, turns, wall, periodic>(t, g, with, records, record_places);
    if constexpr (periodic && !wall)
      if (with.owner != nullptr) [[unlikely]]
        leave_out_virials<n>(t, with);
    total_up<n, turns>(t, total, with.tells_energy, with.lag > 0.0, passes.needs.normal);
    if constexpr (periodic && !wall) add_virials<n>(t, total);
    at.write += static_cast<std::uint32_t>(t.count);
    if (across) at.record += static_cast<std::uint32_t>(t.count);
  }

  /// The pairs of materials of the contacts of a tile.
  EPAFI_LANES PassCall choose_rows(SphereTile<n>& t, const SphereArrays& with) const {
    const std::uint32_t other = wall ? with.planes[range.plane].material : with.own;
    ContactTile<n>* const tile = &t;
    if (with.material == nullptr)
      return {tile, with.passes, with.rows + with.materials * with.own + other, true, with.dt};
    for (std::size_t k = 0; k < t.groups * n; ++k)
      t.row[k] = with.materials * with.material[t.bodies[k].a.slot()] +
                 (wall ? other : std::uint32_t{with.material[t.bodies[k].b.slot()]});
    return {tile, with.passes, with.rows, false, with.dt};
  }

  /// The passes of the laws.
  EPAFI_LANES void answer(SphereTile<n>& t, const PassCall& call, const Places& at, std::uint32_t row,
                          const SphereArrays& with) const {
    push_apart(t, call, at, row, with);
    if constexpr (!turns) return;
    const Passes& passes = *with.passes;
    SphereSprings& springs = block.springs;
    TileSpring gathered[SphereTile<n>::most];
    if (passes.tangential == nullptr)
      t.rest_springs();
    else if (!passes.needs.bristles)
      passes.tangential({call, t.gather(springs.friction(), row, gathered), springs.friction() + at.write});
    else
      pull_rows(t, call, at, row);
    if (with.rolling != nullptr)
      with.rolling({{call, passes.needs.rolling ? t.gather(springs.rolling(), row, gathered) : nullptr,
                     springs.rolling() + (passes.needs.rolling ? at.write : 0), with.lag, nullptr},
                    block,
                    with,
                    at,
                    wall,
                    !wall && range.across});
  }

  /// The normal law, and what it remembers.
  EPAFI_LANES void push_apart(const SphereTile<n>& t, const PassCall& call, const Places& at, std::uint32_t row,
                              const SphereArrays& with) const {
    constexpr std::size_t most = SphereTile<n>::most;
    alignas(64) double before[most], now[most], kept[most], pushed[most];
    const Passes& passes = *with.passes;
    const bool moves = with.dt > 0.0;
    SphereSprings& springs = block.springs;
    const double* push_before = kept;
    double* push = nullptr;
    if (passes.needs.push) {
      if (passes.normal == passes.lanes)
        push_before = t.gather(springs.push(), row, kept);
      else  // contacts at edges are read after those of the lanes are written
        t.gather_apart(springs.push(), row, kept);
      push = moves ? springs.push() + at.write : pushed;
    }
    if (passes.needs.normal) t.gather_apart(springs.normal(), row, before);
    passes.normal({call, before, now, push_before, push, with.lag, with.tells_energy, with.ratio});
    if (passes.needs.normal) remember(t, before, now, moves ? springs.normal() + at.write : nullptr);
    if (push != nullptr && !moves) begin_with(t, push_before, push, springs.push());
  }

  /// Friction by rows of bristles. No time passes: a contact that begins remembers how many it has.
  [[gnu::noinline]] void pull_rows(SphereTile<n>& t, const PassCall& call, const Places& at, std::uint32_t row) const {
    thread_local std::vector<PackedBristles> kept(t.most), fresh(t.most);
    SphereSprings& springs = block.springs;
    const bool moves = call.dt > 0.0;
    const PackedBristles* const before = t.gather(springs.bristles(), row, kept.data());
    PackedBristles* const now = moves ? springs.bristles() + at.write : fresh.data();
    call.passes->tangential({call, before, now});
    for (std::size_t k = 0; k < t.count; ++k) {
      const auto& load = t.group[k / n].load;
      if (moves)
        springs.friction()[at.write + k].load = Lanes{load.x[k % n], load.y[k % n], load.z[k % n], 0.0};
      else if (!(before[k].get().width > 0.0) && t.spring[k] != SphereSprings::unloaded)
        springs.bristles()[t.spring[k]] = now[k];
    }
  }

  /// No time passes: only new contacts write what they remember.
  EPAFI_LANES static void begin_with(const SphereTile<n>& t, const double* before, const double* now, double* column) {
    for (std::size_t k = 0; k < t.count; ++k)
      if (before[k] == 0.0 && t.spring[k] != SphereSprings::unloaded) column[t.spring[k]] = now[k];
  }
  /// Memory of the normal law; to: null if no time passes.
  EPAFI_LANES void remember(const SphereTile<n>& t, const double* before, const double* now, double* to) const {
    if (to != nullptr)
      std::copy_n(now, t.count, to);
    else
      begin_with(t, before, now, block.springs.normal());
    // contacts that had broken before are listed within the reach, and hold no more
    if (arrays.reach > 0.0)
      for (std::size_t k = 0; k < t.count; ++k) total.touching -= before[k] == 0.0 && now[k] == 0.0;
  }

  /// Releases the springs of opened contacts among the eight from `first` on; read: place of the first one's spring.
  EPAFI_LANES void release(std::size_t first, unsigned before, unsigned opened, std::uint32_t read) const {
    const auto stored = [](const Lanes& load) {
      return 0.5 * (load[0] * load[0] + load[1] * load[1] + load[2] * load[2]) * load[3];
    };
    for (unsigned bits = opened; bits != 0; bits &= bits - 1u) {
      const std::size_t pair = first + static_cast<std::size_t>(std::countr_zero(bits));
      if (arrays.owner != nullptr && !arrays.counts(block.pairs[pair])) continue;
      const std::uint32_t place = read + bit_places.count[before & ((bits & -bits) - 1u)];
      const SphereNeeds& needs = arrays.passes->needs;
      if (needs.bristles)
        total.released += energy_of(block.springs.bristles()[place].get());
      else if (needs.friction)
        total.released += stored(block.springs.friction()[place].load);
      if (needs.rolling) total.released += stored(block.springs.rolling()[place].load);
    }
  }
};

}  // namespace epafi
