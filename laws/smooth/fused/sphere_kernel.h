/// @file sphere_kernel.h  Hertz-like contact of spheres with a friction spring, n contacts at a time. A first pass
/// looks at all pairs of a run and hands on those that touch; these alone, closed up, go through motion, law, spring
/// and sums, 32 together: each of these loops is short, so that the processor works at several groups at once. The
/// formulas are those of the law parts (respond, stiffness, friction) and of laws/smooth/spring.h; the result equals
/// the generic loop to rounding (tests/physics/test_fused_spheres.cpp), and is the same bits for every n.
#pragma once
#include "laws/smooth/fused/sphere_rolling.h"

namespace epafi {

template <class Normal, class Tangential, class Rolling>
struct SphereLaw {
  typename Normal::Parameters normal{};
  typename Tangential::Parameters tangential{};
  typename Rolling::Parameters rolling{};
};

/// Adds those of the n pairs from `k` on that touch, and returns one bit for each. valid: bits of the run's own.
template <int n, bool wall, bool periodic>
EPAFI_LANES unsigned look(SphereTile<n>& t, const SphereBlocks::Block& block, std::uint32_t k, unsigned valid,
                          const SpherePlane* plane, const SphereArrays& with) {
  using V = typename LanesOf<n>::Real;
  const SpherePlaces* pair = block.pairs + k;
  VectorsOf<V> d;
  V radii;
  unsigned bits;
  if constexpr (wall) {
    read_columns([&](int l) EPAFI_INLINED { return row<n>(with.state(pair[l].a).position); }, d.x, d.y, d.z, radii);
    const Vec3 &out = plane->normal, &p = plane->point;
    d.x = out.x() * (d.x - p.x()) + out.y() * (d.y - p.y()) + out.z() * (d.z - p.z());
    bits = less_bits<n>(d.x, radii) & valid;
  } else {
    read_columns(
        [&](int l) EPAFI_INLINED {  // in the fourth the sum of both instead of the difference
          const auto apart =
              row<n>(with.state(pair[l].b).position) - flip_fourth(row<n>(with.state(pair[l].a).position));
          if constexpr (periodic)
            return apart + row<n>(with.cell_size) * row<n>(block.images[k + static_cast<std::uint32_t>(l)].cells);
          else
            return apart;
        },
        d.x, d.y, d.z, radii);
    bits = less_bits<n>(d.dot(d), radii * radii) & valid;
  }
  for (int l = 0; l < n; ++l) {  // A's lines are those of the pair before
    const SphereState& soon = with.state(pair[SphereBlocks::pairs_ahead + l].b);
    __builtin_prefetch(&soon.position), __builtin_prefetch(&soon.spin);
  }
  const std::size_t at = t.count;
  compress<n>(d.x, bits, t.x + at);
  if constexpr (!wall) compress<n>(d.y, bits, t.y + at), compress<n>(d.z, bits, t.z + at);
  compress<n>(radii, bits, t.radii + at);
  V places;
  static_assert(sizeof(SpherePlaces) == sizeof(double));
  std::memcpy(&places, pair, sizeof places);
  compress<n>(places, bits, t.bodies + at);
  write_places<n>(bits, k, t.pair + at);
  t.count = at + bit_places.count[bits];
  return bits;
}

/// Where the bodies are. Roots and divisions in a loop of their own: they queue for one unit, and no other work waits
/// in between.
template <int n, bool wall>
EPAFI_LANES void find_normal(SphereTile<n>& t, std::size_t g, const SpherePlane* plane) {
  using V = typename LanesOf<n>::Real;
  const V radii = t.column(t.radii, g);
  if constexpr (wall) {
    const Vec3& out = plane->normal;
    t.normal[g] = {filled<n>(-out.x()), filled<n>(-out.y()), filled<n>(-out.z())};
    t.overlap[g] = -(t.column(t.x, g) - radii), t.distance[g] = radii, t.lever[g] = filled<n>(1.0);
    t.radius[g] = radii;
  } else {
    const VectorsOf<V> d{t.column(t.x, g), t.column(t.y, g), t.column(t.z, g)};
    const V distance = sqrt(d.dot(d));
    const MaskOf<V> apart = distance > V{};
    const V length = select(apart, distance, filled<n>(1.0)), both = 1.0 / (length * radii), inverse = radii * both;
    t.normal[g] = {inverse * d.x, inverse * d.y, select(apart, inverse * d.z, filled<n>(1.0))};
    t.overlap[g] = radii - distance, t.distance[g] = distance;
    t.radius[g] = length * both;  // 1/sum of radii for now
    t.lever[g] = distance * t.radius[g];
  }
}

/// Radius of the contact, and with friction how far the surfaces move on each other in the step.
template <int n, bool friction, bool wall>
EPAFI_LANES void find_radii(SphereTile<n>& t, std::size_t g, const SphereArrays& with,
                            const VectorsOf<typename LanesOf<n>::Real>& velocity) {
  using V = typename LanesOf<n>::Real;
  const SpherePlaces* bodies = t.bodies + g * n;
  VectorsOf<V> spin_a, spin_b{};
  V radius_a, radius_b{};
  read_columns([&](int l) EPAFI_INLINED { return row<n>(with.state(bodies[l].a).spin); }, spin_a.x, spin_a.y, spin_a.z,
               radius_a);
  if constexpr (!wall) {
    read_columns([&](int l) EPAFI_INLINED { return row<n>(with.state(bodies[l].b).spin); }, spin_b.x, spin_b.y,
                 spin_b.z, radius_b);
    t.radius[g] = radius_a * radius_b * t.radius[g];
  }
  if constexpr (friction) {
    const VectorsOf<V>& normal = t.normal[g];
    t.twist[g] = 0.5 * with.dt * normal.dot(spin_a + spin_b);
    const VectorsOf<V> turning = t.lever[g] * (radius_a * spin_a + radius_b * spin_b);
    t.displacement[g] = with.dt * (velocity - velocity.dot(normal) * normal - turning.cross(normal));
  }
}

/// How they move against each other.
template <int n, bool friction, bool wall, bool periodic>
EPAFI_LANES void find_motion(SphereTile<n>& t, std::size_t g, const SphereBlocks::Block& block,
                             const SphereArrays& with) {
  using V = typename LanesOf<n>::Real;
  const SpherePlaces* bodies = t.bodies + g * n;
  VectorsOf<V> velocity, later;
  V inverse_mass, none;
  const VectorsOf<V>& normal = t.normal[g];
  if constexpr (wall) {
    read_columns([&](int l) EPAFI_INLINED { return -flip_fourth(row<n>(with.state(bodies[l].a).velocity)); },
                 velocity.x, velocity.y, velocity.z, inverse_mass);
    read_columns([&](int l) EPAFI_INLINED { return -row<n>(with.state(bodies[l].a).predicted); }, later.x, later.y,
                 later.z, none);
  } else {
    // the flow of a deforming cell comes on top
    const auto flow = [&](int l) EPAFI_INLINED {
      const auto apart =
          row<n>(with.state(bodies[l].b).position) - row<n>(with.state(bodies[l].a).position) +
          row<n>(with.cell_size) * row<n>(block.images[t.pair[g * n + static_cast<std::size_t>(l)]].cells);
      return row<n>(with.strain_rate) * apart;
    };
    read_columns(
        [&](int l) EPAFI_INLINED {
          const auto apart =
              row<n>(with.state(bodies[l].b).velocity) - flip_fourth(row<n>(with.state(bodies[l].a).velocity));
          if constexpr (periodic)
            return apart + flow(l);
          else
            return apart;
        },
        velocity.x, velocity.y, velocity.z, inverse_mass);
    later = velocity;
    if (with.damped)
      read_columns(
          [&](int l) EPAFI_INLINED {
            const auto apart = row<n>(with.state(bodies[l].b).predicted) - row<n>(with.state(bodies[l].a).predicted);
            if constexpr (periodic)
              return apart + flow(l);
            else
              return apart;
          },
          later.x, later.y, later.z, none);
  }
  t.mass[g] = 1.0 / inverse_mass;
  t.approach[g] = -later.dot(normal);
  if constexpr (friction || !wall) find_radii<n, friction, wall>(t, g, with, velocity);
}

template <int n, class Normal, class Tangential, class Rolling>
EPAFI_LANES void find_response(SphereTile<n>& t, std::size_t g, const SphereLaw<Normal, Tangential, Rolling>& law,
                               SphereTotals<n>& total) {
  using V = typename LanesOf<n>::Real;
  KinematicsOf<V> at;
  at.overlap = t.overlap[g], at.approach_velocity = t.approach[g];
  at.effective_mass = t.mass[g], at.effective_radius = t.radius[g];
  const ResponseOf<V> r = Normal::respond(law.normal, at);
  const MaskOf<V> used = t.used(g);
  t.force[g] = r.force;
  total.elastic.add(g, keep(used, r.energy));
  total.viscous.add(g, keep(used, (r.force - r.elastic_force) * at.approach_velocity));
  if constexpr (Tangential::is_present)
    t.stiffness[g] = Tangential::stiffness(law.tangential, r.stiffness),
    t.limit[g] = Tangential::friction(law.tangential) * r.force;
}

/// What a contact adds to the sum of A, and with the force turned round to that of B.
template <int n, bool friction>
struct SumRow {
  RowOf<n> force, pull;
  EPAFI_LANES SumRow turned() const { return {-force, pull}; }
  EPAFI_LANES void add_to(SphereSum& sum) const {
    store<n>(sum.force, row<n>(sum.force) + force);
    if constexpr (friction) store<n>(sum.pull, row<n>(sum.pull) + pull);
  }
  EPAFI_LANES void write(SphereSum& sum) const {
    store<n>(sum.force, force);
    if constexpr (friction)
      store<n>(sum.pull, pull);
    else
      sum.pull = Lanes{};
  }
};
/// Both in one register.
template <>
struct SumRow<8, true> {
  LanesOf<8>::Real both;
  EPAFI_LANES SumRow turned() const {
    constexpr long long sign = static_cast<long long>(1ull << 63);
    return {reinterpret_cast<LanesOf<8>::Real>(reinterpret_cast<LanesOf<8>::Mask>(both) ^
                                               LanesOf<8>::Mask{sign, sign, sign, sign, 0, 0, 0, 0})};
  }
  EPAFI_LANES void add_to(SphereSum& sum) const { reinterpret_cast<LanesOf<8>::Real&>(sum) += both; }
  EPAFI_LANES void write(SphereSum& sum) const { reinterpret_cast<LanesOf<8>::Real&>(sum) = both; }
};

template <int n, bool friction>
EPAFI_LANES void write_sum_rows(const VectorsOf<typename LanesOf<n>::Real>& force,
                                const VectorsOf<typename LanesOf<n>::Real>& pull, SumRow<n, friction>* rows) {
  if constexpr (n == 8 && friction) {
    LanesOf<8>::Real both[n];
    write_both(force, pull, both);
    for (int l = 0; l < n; ++l) rows[l].both = both[l];
  } else {
    RowOf<n> forces[n], pulls[n]{};
    write_rows(force.x, force.y, force.z, typename LanesOf<n>::Real{}, forces);
    if constexpr (friction) write_rows(pull.x, pull.y, pull.z, typename LanesOf<n>::Real{}, pulls);
    for (int l = 0; l < n; ++l) rows[l] = {forces[l], pulls[l]};
  }
}

template <LaneVector V>
EPAFI_LANES VectorsOf<V> keep(MaskOf<V> mask, const VectorsOf<V>& x) {
  return {keep(mask, x.x), keep(mask, x.y), keep(mask, x.z)};
}

/// Adds to sums; of B to records where it lies in another block.
template <int n, bool friction, bool wall, bool across, bool periodic>
EPAFI_LANES void add_forces(const SphereTile<n>& t, std::size_t g, const SphereBlocks::Block& block,
                            const SphereBlocks::Run& run, const SphereArrays& with, SphereTotals<n>& total) {
  using V = typename LanesOf<n>::Real;
  const VectorsOf<V>&normal = t.normal[g], &load = t.load[g];
  VectorsOf<V> f = -(t.force[g] * normal), moment{};
  if constexpr (friction) f = f + load, moment = t.lever[g] * normal.cross(load);
  const MaskOf<V> used = t.used(g);
  if constexpr (periodic && !wall) {
    const V arm = keep(used, t.distance[g]);
    total.virial[0].add(g, arm * normal.x * f.x), total.virial[1].add(g, arm * normal.y * f.y);
    total.virial[2].add(g, arm * normal.z * f.z);
  }
  SumRow<n, friction> rows[n];
  write_sum_rows<n, friction>(keep(used, f), keep(used, moment), rows);
  const SpherePlaces* bodies = t.bodies + g * n;
  for (int l = 0; l < n; ++l) {  // lane by lane, A and B: the order of a body's sum is not that of groups
    rows[l].add_to(with.sum(bodies[l].a));
    if constexpr (!wall && !across) rows[l].turned().add_to(with.sum(bodies[l].b));
  }
  if constexpr (across) {
    const std::uint32_t* pair = t.pair + g * n;
    for (std::size_t l = 0; l < n && g * n + l < t.count; ++l)
      rows[l].turned().write(with.records[block.record + pair[l] - run.begin]);
  }
}

/// The first contacts of a tile through all loops; `count` of them, at most `most`.
template <int n, class Normal, class Tangential, class Rolling, bool wall, bool across, bool periodic>
EPAFI_LANES void evaluate(SphereTile<n>& t, SphereBlocks::Block& block, const SphereBlocks::Run& run,
                          const SphereLaw<Normal, Tangential, Rolling>& law, const SphereArrays& with,
                          SphereTotals<n>& total) {
  constexpr bool friction = Tangential::is_present;
  const SpherePlane* plane = wall ? with.planes + run.plane : nullptr;
  t.groups = (t.count + n - 1) / n;
  for (std::size_t k = t.count; k < t.groups * n; ++k) {
    t.x[k] = t.x[t.count - 1], t.y[k] = t.y[t.count - 1], t.z[k] = t.z[t.count - 1], t.radii[k] = t.radii[t.count - 1];
    t.bodies[k] = t.bodies[t.count - 1], t.pair[k] = t.pair[t.count - 1];
  }
  for (std::size_t g = 0; g < t.groups; ++g) find_normal<n, wall>(t, g, plane);
  for (std::size_t g = 0; g < t.groups; ++g) find_motion<n, friction, wall, periodic>(t, g, block, with);
  for (std::size_t g = 0; g < t.groups; ++g) {  // the law's roots beside the turn: AVX2 46.8 ns a sphere for 48.6
    find_response<n, Normal, Tangential, Rolling>(t, g, law, total);
    if constexpr (friction) turn_springs<n>(t, g, block.springs);
  }
  if constexpr (friction) pull<n>(t, block.springs, with.dt > 0.0, total);
  if constexpr (Rolling::is_present) {
    SphereRolling<n> r;
    roll<n, Tangential, Rolling, wall, periodic>(t, r, law.tangential, law.rolling, block, with, total);
    for (std::size_t g = 0; g < t.groups; ++g) add_moments<n, wall, across>(t, r, g, block, run, with);
  }
  for (std::size_t g = 0; g < t.groups; ++g)
    add_forces<n, friction, wall, across, periodic>(t, g, block, run, with, total);
  total.touching += t.count;
}

/// What contacts that have opened leave behind.
template <int n, bool rolling>
EPAFI_LANES void release(SphereBlocks::Block& block, const SphereBlocks::Run& run, std::size_t first, unsigned opened,
                         const SphereArrays& with, SphereTotals<n>& total) {
  const auto let_go = [&](Lanes& load) {
    total.released += 0.5 * (load[0] * load[0] + load[1] * load[1] + load[2] * load[2]) * load[3];
    load = Lanes{};
  };
  for (std::size_t k = first; opened != 0; opened >>= 1, ++k) {
    if ((opened & 1u) == 0) continue;
    if (run.across) with.records[block.record + k - run.begin] = SphereSum{};
    if (block.springs != nullptr) let_go(block.springs[k].load);
    if constexpr (!rolling) continue;
    if (run.across) with.record_moments[block.record + k - run.begin] = Lanes{};
    let_go(block.rolling[k].load);
  }
}

/// All pairs of a run: those that touch act, those that touched let their springs go.
template <int n, class Normal, class Tangential, class Rolling, bool wall, bool across, bool periodic>
EPAFI_LANES void sweep(SphereBlocks::Block& block, const SphereBlocks::Run& run,
                       const SphereLaw<Normal, Tangential, Rolling>& law, const SphereArrays& with,
                       SphereTotals<n>& total) {
  constexpr std::uint32_t eight = SphereBlocks::pairs_per_byte;
  constexpr std::size_t full = SphereTile<n>::most;
  const SpherePlane* plane = wall ? with.planes + run.plane : nullptr;
  SphereTile<n> t;
  for (std::uint32_t k = run.begin; k < run.end; k += eight) {
    if constexpr (Tangential::is_present)  // their turn comes when 32 that touch have been found
      for (std::uint32_t l = 0; l < eight; l += 2) __builtin_prefetch(&block.springs[k + l], 1);
    if constexpr (Rolling::is_present)
      for (std::uint32_t l = 0; l < eight; l += 2) __builtin_prefetch(&block.rolling[k + l], 1);
    const unsigned valid = run.end - k < eight ? (1u << (run.end - k)) - 1u : 255u;
    unsigned now = 0;
    for (std::uint32_t l = 0; l < eight; l += n)
      now |= look<n, wall, periodic>(t, block, k + l, valid >> l & ((1u << n) - 1u), plane, with) << l;
    std::uint8_t& before = block.touched[k / eight];
    if (const unsigned opened = before & ~now; with.dt > 0.0) {
      if (opened != 0) release<n, Rolling::is_present>(block, run, k, opened, with, total);
      before = static_cast<std::uint8_t>(now);
    } else {
      before = static_cast<std::uint8_t>(before | now);  // no time passes: what is remembered stays
    }
    if (t.count < full) continue;
    const std::size_t found = t.count;
    t.count = full;
    evaluate<n, Normal, Tangential, Rolling, wall, across, periodic>(t, block, run, law, with, total);
    t.count = found - full;
    for (std::size_t l = 0; l < eight; ++l) {
      t.x[l] = t.x[full + l], t.y[l] = t.y[full + l], t.z[l] = t.z[full + l], t.radii[l] = t.radii[full + l];
      t.bodies[l] = t.bodies[full + l], t.pair[l] = t.pair[full + l];
    }
  }
  if (t.count > 0) evaluate<n, Normal, Tangential, Rolling, wall, across, periodic>(t, block, run, law, with, total);
}

}  // namespace epafi
