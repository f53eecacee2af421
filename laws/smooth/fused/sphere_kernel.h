/// @file sphere_kernel.h  Hertz-like contact of spheres with a friction spring, four contacts at a time. A first pass
/// looks at all pairs of a run and names those that touch; these alone, closed up, go through gap, motion, law, spring
/// and sums, eight groups of four together: each of these loops is short, so that the processor works at several groups
/// at once. The formulas are those of the law parts (respond, stiffness, friction) and of laws/smooth/spring.h; the
/// result equals the generic loop to rounding (tests/physics/test_fused_spheres.cpp).
#pragma once
#include <array>

#include "laws/contact_law.h"
#include "laws/smooth/fused/sphere_blocks.h"

/// Behind the parameters of a lambda that works on lanes: a function of its own keeps the baseline (engine/targets.h).
#define EPAFI_INLINED __attribute__((always_inline))

namespace epafi {

template <class Normal, class Tangential>
struct SphereLaw {
  typename Normal::Parameters normal{};
  typename Tangential::Parameters tangential{};
};

/// What the pairs of a block read and write.
struct SphereArrays {
  const SpherePlane* planes;
  const SphereState* states;
  SphereSum *sums, *records;
  double dt;
  bool damped;
  Lanes cell_size, strain_rate;  ///< of a periodic cell [m], [1/s]; fourth 0
};

/// What a run found, by lane: sums in the order of the contacts that touch.
struct SphereTotals {
  Lanes elastic{}, slipped{}, viscous{};  ///< [J], [J], [W]
  Lanes3 virial{};
  double released = 0.0;  ///< energy of the springs of contacts that opened [J]
  std::size_t touching = 0;
};

/// Contacts on their way through the loops. Lanes behind the last contact repeat it and add nothing.
struct SphereTile {
  static constexpr std::size_t size = 8;
  std::uint32_t pair[size * lane_count];
  std::size_t count = 0, groups = 0;  ///< of contacts, of groups that hold them
  LaneMask used[size];
  Lanes3 branch[size];   ///< from centre to centre [m]
  Lanes square[size];    ///< its length squared [m^2]; of the spring's load: [N^2]
  Lanes radii[size];     ///< sum of both [m]
  Lanes distance[size];  ///< of centres [m]
  Lanes lever[size];     ///< distance over sum of radii
  Lanes3 normal[size];   ///< from A to B; of walls: into the wall
  Lanes overlap[size], approach[size], mass[size], radius[size];
  Lanes3 displacement[size];                             ///< slip of the step [m]
  Lanes twist[size];                                     ///< about the normal in the step [rad]
  Lanes force[size];                                     ///< [N]
  Lanes stiffness[size], compliance[size], limit[size];  ///< of the spring [N/m], [m/N], [N]
  // of the spring: load squared, energy [J], old compliance times stiffness
  Lanes before[size], energy[size], shrink[size];
  Lanes3 start[size], load[size];  ///< of the spring, as it comes into the step and now [N]
};

EPAFI_LANES Lanes flip_fourth(Lanes x) {
  constexpr LaneMask sign{0, 0, 0, static_cast<long long>(1ull << 63)};
  return reinterpret_cast<Lanes>(reinterpret_cast<LaneMask>(x) ^ sign);
}

/// From A to B, and in the fourth the sum of both instead of the difference.
EPAFI_LANES Lanes between(Lanes a, Lanes b) { return b - flip_fourth(a); }

/// Pairs of four lanes: the rows f(lane) as columns.
template <class F>
EPAFI_LANES void read_columns(const F& f, Lanes& x, Lanes& y, Lanes& z, Lanes& w) {
  x = f(0), y = f(1), z = f(2), w = f(3);
  transpose(x, y, z, w);
}

/// Lanes of the four pairs from `k` on that touch, one bit each.
template <bool wall, bool periodic>
EPAFI_LANES unsigned find_touching(const SphereBlocks::Block& block, std::size_t k, const SpherePlane* plane,
                                   const SphereArrays& with) {
  const SphereSlots* pair = block.pairs.data() + k;
  const SphereState* s = with.states;
  Lanes3 d;
  Lanes reach;
  LaneMask touching;
  if constexpr (wall) {
    read_columns([&](int l) EPAFI_INLINED { return s[pair[l].a].position; }, d.x, d.y, d.z, reach);
    const Vec3 &n = plane->normal, &p = plane->point;
    touching = n.x() * (d.x - p.x()) + n.y() * (d.y - p.y()) + n.z() * (d.z - p.z()) < reach;
  } else {
    read_columns(
        [&](int l) EPAFI_INLINED {
          const Lanes row = between(s[pair[l].a].position, s[pair[l].b].position);
          return periodic ? row + with.cell_size * block.images[k + static_cast<std::size_t>(l)].cells : row;
        },
        d.x, d.y, d.z, reach);
    touching = d.dot(d) < reach * reach;
  }
  const LaneMask bits = touching & LaneMask{1, 2, 4, 8};
  return static_cast<unsigned>((bits[0] | bits[1]) | (bits[2] | bits[3]));
}

/// Where the bodies are.
template <bool wall, bool periodic>
EPAFI_LANES void find_branch(SphereTile& t, std::size_t g, const SphereBlocks::Block& block, const SpherePlane* plane,
                             const SphereArrays& with) {
  const std::uint32_t* k = t.pair + g * lane_count;
  const SphereState* s = with.states;
  Lanes3 d;
  if constexpr (wall) {
    read_columns([&](int l) EPAFI_INLINED { return s[block.pairs[k[l]].a].position; }, d.x, d.y, d.z, t.radii[g]);
    const Vec3 &out = plane->normal, &p = plane->point;
    t.normal[g] = {lanes(-out.x()), lanes(-out.y()), lanes(-out.z())};
    const Lanes above = out.x() * (d.x - p.x()) + out.y() * (d.y - p.y()) + out.z() * (d.z - p.z());
    t.overlap[g] = -(above - t.radii[g]), t.distance[g] = t.radii[g], t.lever[g] = lanes(1.0), t.radius[g] = t.radii[g];
  } else {
    read_columns(
        [&](int l) EPAFI_INLINED {
          const Lanes row = between(s[block.pairs[k[l]].a].position, s[block.pairs[k[l]].b].position);
          return periodic ? row + with.cell_size * block.images[k[l]].cells : row;
        },
        d.x, d.y, d.z, t.radii[g]);
    t.branch[g] = d, t.square[g] = d.dot(d);
  }
}

/// Roots and divisions in a loop of their own: they queue for one unit, and no other work waits in between.
EPAFI_LANES void find_normal(SphereTile& t, std::size_t g) {
  const Lanes distance = sqrt(t.square[g]), radii = t.radii[g];
  const LaneMask apart = distance > Lanes{};
  const Lanes length = select(apart, distance, lanes(1.0)), both = 1.0 / (length * radii), inverse = radii * both;
  const Lanes3 d = t.branch[g];
  t.normal[g] = {inverse * d.x, inverse * d.y, select(apart, inverse * d.z, lanes(1.0))};
  t.overlap[g] = radii - distance, t.distance[g] = distance;
  t.radius[g] = length * both;  // 1/sum of radii for now
  t.lever[g] = distance * t.radius[g];
}

/// Radius of the contact, and with friction how far the surfaces move on each other in the step.
template <bool friction, bool wall>
EPAFI_LANES void find_radii(SphereTile& t, std::size_t g, const SphereState* const (&a)[lane_count],
                            const SphereState* const (&b)[lane_count], const Lanes3& velocity, double dt) {
  if constexpr (friction) {
    Lanes3 spin_a, spin_b{};
    Lanes radius_a, radius_b{};
    read_columns([&](int l) EPAFI_INLINED { return a[l]->spin; }, spin_a.x, spin_a.y, spin_a.z, radius_a);
    if constexpr (!wall) {
      read_columns([&](int l) EPAFI_INLINED { return b[l]->spin; }, spin_b.x, spin_b.y, spin_b.z, radius_b);
      t.radius[g] = radius_a * radius_b * t.radius[g];
    }
    const Lanes3& n = t.normal[g];
    t.twist[g] = 0.5 * dt * n.dot(spin_a + spin_b);
    const Lanes3 turning = t.lever[g] * (radius_a * spin_a + radius_b * spin_b);
    t.displacement[g] = dt * (velocity - velocity.dot(n) * n - turning.cross(n));
  } else if constexpr (!wall) {
    const auto radius = [](const SphereState* const* s) EPAFI_INLINED {
      return Lanes{s[0]->spin[3], s[1]->spin[3], s[2]->spin[3], s[3]->spin[3]};
    };
    t.radius[g] = radius(a) * radius(b) * t.radius[g];
  }
}

/// How they move against each other.
template <bool friction, bool wall, bool periodic>
EPAFI_LANES void find_motion(SphereTile& t, std::size_t g, const SphereBlocks::Block& block, const SphereArrays& with) {
  const std::uint32_t* k = t.pair + g * lane_count;
  const SphereSlots* pairs = block.pairs.data();
  const SphereState *a[lane_count], *b[lane_count];
  for (int l = 0; l < lane_count; ++l)
    a[l] = with.states + pairs[k[l]].a, b[l] = wall ? a[l] : with.states + pairs[k[l]].b;
  Lanes3 velocity, later;
  Lanes inverse_mass, none;
  const Lanes3& n = t.normal[g];
  if constexpr (wall) {
    read_columns([&](int l) EPAFI_INLINED { return -flip_fourth(a[l]->velocity); }, velocity.x, velocity.y, velocity.z,
                 inverse_mass);
    read_columns([&](int l) EPAFI_INLINED { return -a[l]->predicted; }, later.x, later.y, later.z, none);
  } else {
    // the flow of a deforming cell comes on top
    const auto flow = [&](int l) EPAFI_INLINED {
      const Lanes apart = b[l]->position - a[l]->position + with.cell_size * block.images[k[l]].cells;
      return with.strain_rate * apart;
    };
    read_columns(
        [&](int l) EPAFI_INLINED {
          const Lanes row = between(a[l]->velocity, b[l]->velocity);
          return periodic ? row + flow(l) : row;
        },
        velocity.x, velocity.y, velocity.z, inverse_mass);
    later = velocity;
    if (with.damped)
      read_columns(
          [&](int l) EPAFI_INLINED {
            const Lanes row = b[l]->predicted - a[l]->predicted;
            return periodic ? row + flow(l) : row;
          },
          later.x, later.y, later.z, none);
  }
  t.mass[g] = 1.0 / inverse_mass;
  t.approach[g] = -later.dot(n);
  find_radii<friction, wall>(t, g, a, b, velocity, with.dt);
}

template <class Normal, class Tangential>
EPAFI_LANES void find_response(SphereTile& t, std::size_t g, const SphereLaw<Normal, Tangential>& law,
                               SphereTotals& total) {
  KinematicsOf<Lanes> at;
  at.overlap = t.overlap[g], at.approach_velocity = t.approach[g];
  at.effective_mass = t.mass[g], at.effective_radius = t.radius[g];
  const ResponseOf<Lanes> r = Normal::respond(law.normal, at);
  t.force[g] = r.force;
  total.elastic += keep(t.used[g], r.energy);
  total.viscous += keep(t.used[g], (r.force - r.elastic_force) * at.approach_velocity);
  if constexpr (Tangential::is_present)
    t.stiffness[g] = Tangential::stiffness(law.tangential, r.stiffness),
    t.limit[g] = Tangential::friction(law.tangential) * r.force;
}

/// laws/smooth/spring.h: the old load turns with the plane, shrinks with the stiffness, follows the slip and stays
/// below the limit. Remembered beside it is 1/stiffness: one division serves the energy now and, in the next step, the
/// energy before and the shrinking.
EPAFI_LANES void turn_springs(SphereTile& t, std::size_t g, const SphereSpring* springs) {
  const std::uint32_t* pair = t.pair + g * lane_count;
  const Lanes3& n = t.normal[g];
  Lanes3 old;
  Lanes compliance;
  read_columns([&](int l) EPAFI_INLINED { return springs[pair[l]].load; }, old.x, old.y, old.z, compliance);
  const Lanes3 load = old + t.twist[g] * n.cross(old);
  t.start[g] = load - n.dot(load) * n;
  t.before[g] = old.dot(old), t.square[g] = t.start[g].dot(t.start[g]);
  t.energy[g] = 0.5 * t.before[g] * compliance;
  t.shrink[g] = compliance * t.stiffness[g];
}

/// The turned load has its old length, and 1/stiffness: by one division.
EPAFI_LANES void scale_springs(SphereTile& t, std::size_t g) {
  const Lanes after = t.square[g], stiffness = t.stiffness[g];
  const LaneMask turns = after > lanes(1e-200), stiff = stiffness > Lanes{};  // loads below 1e-100 N are none
  const Lanes some = select(turns, after, lanes(1.0)), k = select(stiff, stiffness, lanes(1.0));
  const Lanes both = 1.0 / (some * k);
  t.start[g] = keep(turns, sqrt(t.before[g] * (k * both))) * t.start[g];
  t.compliance[g] = keep(stiff, some * both);
}

/// True where some lane slides.
EPAFI_LANES bool stretch_springs(SphereTile& t, std::size_t g) {
  const Lanes shrink = t.shrink[g];  // below 1 where the contact has become softer; a new one has no load
  t.load[g] = select(shrink < lanes(1.0), shrink, lanes(1.0)) * t.start[g] + t.stiffness[g] * t.displacement[g];
  t.square[g] = t.load[g].dot(t.load[g]);
  return any(t.square[g] > t.limit[g] * t.limit[g]);
}

EPAFI_LANES void slide(SphereTile& t, std::size_t g) {
  const Lanes square = t.square[g], limit = t.limit[g];
  const LaneMask slides = square > limit * limit;
  t.load[g] = select(slides, limit / sqrt(select(slides, square, lanes(1.0))), lanes(1.0)) * t.load[g];
  t.square[g] = t.load[g].dot(t.load[g]);
}

EPAFI_LANES void settle_springs(SphereTile& t, std::size_t g, SphereSpring* springs, bool remember,
                                SphereTotals& total) {
  const std::uint32_t* pair = t.pair + g * lane_count;
  const Lanes energy = 0.5 * t.square[g] * t.compliance[g];
  const Lanes work = 0.5 * (t.start[g] + t.load[g]).dot(t.displacement[g]);
  total.elastic += keep(t.used[g], energy);
  total.slipped += keep(t.used[g], work - (energy - t.energy[g]));
  if (!remember) return;
  Lanes x = t.load[g].x, y = t.load[g].y, z = t.load[g].z, w = t.compliance[g];
  transpose(x, y, z, w);
  springs[pair[0]].load = x, springs[pair[1]].load = y, springs[pair[2]].load = z, springs[pair[3]].load = w;
}

EPAFI_LANES void pull(SphereTile& t, SphereSpring* springs, bool remember, SphereTotals& total) {
  bool slides[SphereTile::size];
  for (std::size_t g = 0; g < t.groups; ++g) turn_springs(t, g, springs);
  for (std::size_t g = 0; g < t.groups; ++g) scale_springs(t, g);
  for (std::size_t g = 0; g < t.groups; ++g) slides[g] = stretch_springs(t, g);
  for (std::size_t g = 0; g < t.groups; ++g)
    if (slides[g]) slide(t, g);
  for (std::size_t g = 0; g < t.groups; ++g) settle_springs(t, g, springs, remember, total);
}

/// Adds to sums; of B to records where it lies in another block.
template <bool friction, bool wall, bool across, bool periodic>
EPAFI_LANES void add_forces(const SphereTile& t, std::size_t g, const SphereBlocks::Block& block,
                            const SphereBlocks::Run& run, const SphereArrays& with, SphereTotals& total) {
  const std::uint32_t* pair = t.pair + g * lane_count;
  SphereSum* sums = with.sums;
  const Lanes3 &n = t.normal[g], &load = t.load[g];
  Lanes3 f = -(t.force[g] * n), moment{};
  if constexpr (friction) f = f + load, moment = t.lever[g] * n.cross(load);
  const LaneMask used = t.used[g];
  if constexpr (periodic && !wall) {
    const Lanes arm = keep(used, t.distance[g]);
    total.virial = total.virial + Lanes3{arm * n.x * f.x, arm * n.y * f.y, arm * n.z * f.z};
  }
  Lanes force[4] = {keep(used, f.x), keep(used, f.y), keep(used, f.z), Lanes{}};
  Lanes pull[4] = {keep(used, moment.x), keep(used, moment.y), keep(used, moment.z), Lanes{}};
  transpose(force[0], force[1], force[2], force[3]);
  if constexpr (friction) transpose(pull[0], pull[1], pull[2], pull[3]);
  // lane by lane, A and B: the order of a body's sum must not depend on which contacts share a group
  for (std::size_t l = 0; l < lane_count; ++l) {
    const SphereSlots slots = block.pairs[pair[l]];
    sums[slots.a].force += force[l];
    if constexpr (friction) sums[slots.a].pull += pull[l];
    if constexpr (!wall && !across) {
      sums[slots.b].force -= force[l];
      if constexpr (friction) sums[slots.b].pull += pull[l];
    }
    if constexpr (across)
      if (used[static_cast<int>(l)] != 0)
        with.records[block.record + pair[l] - run.begin] = {-force[l], friction ? pull[l] : Lanes{}};
  }
}

/// The contacts of a tile through all loops; `count` of them.
template <class Normal, class Tangential, bool wall, bool across, bool periodic>
EPAFI_LANES void evaluate(SphereTile& t, SphereBlocks::Block& block, const SphereBlocks::Run& run,
                          const SphereLaw<Normal, Tangential>& law, const SphereArrays& with, SphereTotals& total) {
  constexpr bool friction = Tangential::is_present;
  const SpherePlane* plane = wall ? with.planes + run.plane : nullptr;
  t.groups = (t.count + lane_count - 1) / lane_count;
  for (std::size_t k = t.count; k < t.groups * lane_count; ++k) t.pair[k] = t.pair[t.count - 1];
  for (std::size_t g = 0; g < t.groups; ++g) {
    const auto left = static_cast<long long>(t.count - g * lane_count);
    t.used[g] = LaneMask{0, 1, 2, 3} < LaneMask{left, left, left, left};
  }
  for (std::size_t g = 0; g < t.groups; ++g) find_branch<wall, periodic>(t, g, block, plane, with);
  if constexpr (!wall)
    for (std::size_t g = 0; g < t.groups; ++g) find_normal(t, g);
  for (std::size_t g = 0; g < t.groups; ++g) find_motion<friction, wall, periodic>(t, g, block, with);
  for (std::size_t g = 0; g < t.groups; ++g) find_response<Normal, Tangential>(t, g, law, total);
  if constexpr (friction) pull(t, block.springs.data(), with.dt > 0.0, total);
  for (std::size_t g = 0; g < t.groups; ++g)
    add_forces<friction, wall, across, periodic>(t, g, block, run, with, total);
  total.touching += t.count;
}

/// What contacts that have opened leave behind.
EPAFI_LANES void release(SphereBlocks::Block& block, const SphereBlocks::Run& run, std::size_t first, unsigned opened,
                         SphereSum* records, SphereTotals& total) {
  for (std::size_t k = first; opened != 0; opened >>= 1, ++k) {
    if ((opened & 1u) == 0) continue;
    if (run.across) records[block.record + k - run.begin] = SphereSum{};
    if (block.springs.empty()) continue;
    Lanes& load = block.springs[k].load;
    total.released += 0.5 * (load[0] * load[0] + load[1] * load[1] + load[2] * load[2]) * load[3];
    load = Lanes{};
  }
}

/// Places of the set bits of four, and how many they are.
struct BitPlaces {
  using Four = std::uint32_t __attribute__((vector_size(16)));
  std::array<Four, 16> at{};
  std::array<std::uint32_t, 16> count{};
};
inline constexpr BitPlaces bit_places = [] {
  BitPlaces out;
  for (std::uint32_t bits = 0; bits < 16; ++bits) {
    std::uint32_t at[4] = {}, n = 0;
    for (std::uint32_t l = 0; l < 4; ++l)
      if (bits >> l & 1u) at[n++] = l;
    out.at[bits] = BitPlaces::Four{at[0], at[1], at[2], at[3]}, out.count[bits] = n;
  }
  return out;
}();

/// All pairs of a run: those that touch act, those that touched let their springs go.
template <class Normal, class Tangential, bool wall, bool across, bool periodic>
EPAFI_LANES void sweep(SphereBlocks::Block& block, const SphereBlocks::Run& run,
                       const SphereLaw<Normal, Tangential>& law, const SphereArrays& with, SphereTotals& total) {
  constexpr std::uint32_t full = SphereTile::size * lane_count;
  const SpherePlane* plane = wall ? with.planes + run.plane : nullptr;
  SphereTile t;
  std::uint32_t found[full + lane_count];
  std::uint32_t n = 0;
  for (std::uint32_t k = run.begin; k < run.end; k += lane_count) {
    unsigned now = find_touching<wall, periodic>(block, k, plane, with);
    if (k + lane_count > run.end) now &= (1u << (run.end - k)) - 1u;
    std::uint8_t& before = block.touched[k / lane_count];
    if (const unsigned opened = before & ~now; with.dt > 0.0) {
      if (opened != 0) release(block, run, k, opened, with.records, total);
      before = static_cast<std::uint8_t>(now);
    } else {
      before = static_cast<std::uint8_t>(before | now);  // no time passes: what is remembered stays
    }
    const BitPlaces::Four places = bit_places.at[now] + BitPlaces::Four{k, k, k, k};
    __builtin_memcpy(found + n, &places, sizeof places);
    n += bit_places.count[now];
    if (n < full) continue;
    __builtin_memcpy(t.pair, found, sizeof t.pair), t.count = full;
    evaluate<Normal, Tangential, wall, across, periodic>(t, block, run, law, with, total);
    n -= full;
    for (std::uint32_t l = 0; l < lane_count; ++l) found[l] = found[full + l];
  }
  if (n == 0) return;
  for (std::uint32_t l = 0; l < n; ++l) t.pair[l] = found[l];
  t.count = n;
  evaluate<Normal, Tangential, wall, across, periodic>(t, block, run, law, with, total);
}

}  // namespace epafi
