/// @file sphere_rolling.h  What dashpots beside friction springs (laws/smooth/dashpot.h) and resistance to rolling
/// (laws/smooth/rolling.h) add to the loop over spheres, behind its friction springs. The formulas are those of
/// SmoothContact::damp and roll.
#pragma once
#include "laws/smooth/fused/sphere_tile.h"

namespace epafi {

/// How the contacts of a tile slip and roll, and what they feel.
template <int n>
struct SphereRolling {
  using V = typename LanesOf<n>::Real;
  using V3 = VectorsOf<V>;
  static constexpr std::size_t size = SphereTile<n>::size;
  V3 slip[size], spin[size];        ///< velocities at the time of the detection [m/s], [rad/s]
  V3 turning[size];                 ///< against each other, in the middle of the step [rad/s]
  V slip_mobility[size];            ///< [1/kg]
  V inertia[size];                  ///< about the contact [kg m^2]
  V dashpot[size];                  ///< against rolling [N m s]
  V3 friction[size], moment[size];  ///< on A [N], [N m]
};

template <LaneVector V>
EPAFI_LANES VectorsOf<V> within(const VectorsOf<V>& load, const V& limit) {
  const V square = load.dot(load);
  const MaskOf<V> over = square > limit * limit;
  const V length = sqrt(select(over, square, V{} + 1.0));
  return select(over, limit / length, V{} + 1.0) * load;
}

template <LaneVector V>
EPAFI_LANES VectorsOf<V> in_plane(const VectorsOf<V>& x, const VectorsOf<V>& normal) {
  return x - x.dot(normal) * normal;
}

/// Motion of one side of n contacts, and how easily it gives.
template <int n>
struct SphereSide {
  using V = typename LanesOf<n>::Real;
  VectorsOf<V> velocity{}, spin{}, late_spin{};  ///< velocity: at the time of the detection
  V radius{}, slip_mobility{}, rolling_mobility{};

  /// place(lane): of the body.
  template <class Place>
  EPAFI_LANES void read(const SphereArrays& with, const Place& place, const V& lever) {
    V inverse_inertia, none;
    read_columns([&](int l) EPAFI_INLINED { return row<n>(with.state(place(l)).predicted); }, velocity.x, velocity.y,
                 velocity.z, inverse_inertia);
    read_columns([&](int l) EPAFI_INLINED { return row<n>(with.state(place(l)).spin); }, spin.x, spin.y, spin.z,
                 radius);
    read_columns([&](int l) EPAFI_INLINED { return row<n>(with.late_spin(place(l))); }, late_spin.x, late_spin.y,
                 late_spin.z, none);
    V inverse_mass{};
    for (int l = 0; l < n; ++l) inverse_mass[l] = with.state(place(l)).velocity[3];
    const V arm = radius * lever, turning = arm * arm * inverse_inertia;
    slip_mobility = inverse_mass + turning;
    rolling_mobility = inverse_inertia * inverse_mass / slip_mobility;
  }
};

template <int n, bool wall, bool periodic>
EPAFI_LANES void find_rolling(const SphereTile<n>& t, SphereRolling<n>& r, std::size_t g, const SphereArrays& with) {
  using V = typename LanesOf<n>::Real;
  const SpherePlaces* bodies = t.bodies + g * n;
  const VectorsOf<V> normal = t.normal(g);
  SphereSide<n> a, b;
  a.read(
      with, [&](int l) EPAFI_INLINED { return bodies[l].a; }, t.group[g].lever);
  if constexpr (!wall)
    b.read(
        with, [&](int l) EPAFI_INLINED { return bodies[l].b; }, t.group[g].lever);
  VectorsOf<V> velocity = b.velocity - a.velocity;
  if constexpr (periodic && !wall) {  // the flow of a deforming cell comes on top
    const V length = t.column(t.distance, g);
    const Lanes& rate = with.strain_rate;
    velocity =
        velocity + VectorsOf<V>{rate[0] * length * normal.x, rate[1] * length * normal.y, rate[2] * length * normal.z};
  }
  const VectorsOf<V> turning = t.group[g].lever * (a.radius * a.late_spin + b.radius * b.late_spin);
  r.slip[g] = in_plane(velocity, normal) - turning.cross(normal);
  r.spin[g] = in_plane(b.late_spin - a.late_spin, normal);
  r.turning[g] = in_plane(b.spin - a.spin, normal);
  r.slip_mobility[g] = a.slip_mobility + b.slip_mobility;
  r.inertia[g] = 1.0 / (a.rolling_mobility + b.rolling_mobility);
}

/// The friction spring pulls with t.load; it and its dashpot slide together.
template <int n, class Tangential>
EPAFI_LANES void damp(SphereTile<n>& t, SphereRolling<n>& r, std::size_t g, const typename Tangential::Parameters& p) {
  using V = typename LanesOf<n>::Real;
  const V dashpot = 2.0 * p.damping * sqrt(t.group[g].stiffness / r.slip_mobility[g]);
  r.friction[g] = within(t.group[g].load + dashpot * r.slip[g], t.group[g].limit);
  t.group[g].viscous += (r.friction[g] - t.group[g].load).dot(r.slip[g]);
}

/// The rolling spring takes the place of the friction spring in the tile.
template <int n, class Tangential, class Rolling>
EPAFI_LANES void prepare_rolling(SphereTile<n>& t, SphereRolling<n>& r, std::size_t g,
                                 const typename Tangential::Parameters& tangential,
                                 const typename Rolling::Parameters& p, double dt) {
  using V = typename LanesOf<n>::Real;
  RollingStepOf<V> step;
  step.normal_stiffness = t.group[g].stiffness / Tangential::stiffness(tangential, 1.0),
  step.normal_force = t.group[g].force;
  step.radius = t.group[g].radius, step.inertia = r.inertia[g], step.spin = sqrt(r.spin[g].dot(r.spin[g])),
  step.dt = dt;
  r.dashpot[g] = Rolling::damping(p, step);
  t.group[g].stiffness = Rolling::stiffness(p, step), t.group[g].limit = Rolling::limit(p, step);
  t.group[g].slip = r.turning[g];
}

/// Adds the moments to the sums as add_forces does the forces; of B to records where it lies in another block.
template <int n, bool wall, bool across>
EPAFI_LANES void add_moments(const SphereTile<n>& t, const SphereRolling<n>& r, std::size_t g,
                             SphereBlocks::Block& block, SphereSprings::Places at, const SphereArrays& with) {
  using V = typename LanesOf<n>::Real;
  const VectorsOf<V>&moment = r.moment[g], &friction = r.friction[g];
  RowOf<n> rows[n], pulls[n];
  write_rows(moment.x, moment.y, moment.z, V{}, rows);
  write_rows(friction.x, friction.y, friction.z, V{}, pulls);
  const SpherePlaces* bodies = t.bodies + g * n;
  SphereLoads* const loads = block.springs.loads();
  for (std::size_t l = 0; l < n && g * n + l < t.count; ++l) {
    Lanes& a = with.moment(bodies[l].a);
    store<n>(a, row<n>(a) + rows[l]);
    if constexpr (across) store<n>(block.record_moments[at.record + g * n + l], -rows[l]);
    if constexpr (!wall && !across) {
      Lanes& b = with.moment(bodies[l].b);
      store<n>(b, row<n>(b) - rows[l]);
    }
    SphereLoads& now = loads[with.dt > 0.0 ? at.write + g * n + l : t.spring[g * n + l]];
    store<n>(now.friction, pulls[l]), store<n>(now.moment, rows[l]);
  }
}

/// Behind `pull` of the friction springs: dashpots, then the rolling springs through the same loops.
template <int n, class Tangential, class Rolling, bool wall, bool periodic>
EPAFI_LANES void roll(SphereTile<n>& t, SphereRolling<n>& r, const typename Tangential::Parameters& tangential,
                      const typename Rolling::Parameters& p, SphereSprings& springs, std::uint32_t row,
                      std::uint32_t write, const SphereArrays& with) {
  SphereSpring gathered[SphereTile<n>::most];
  for (std::size_t g = 0; g < t.groups; ++g) settle_springs<n>(t, g, springs.friction() + write, with.dt);
  for (std::size_t g = 0; g < t.groups; ++g) find_rolling<n, wall, periodic>(t, r, g, with);
  for (std::size_t g = 0; g < t.groups; ++g) damp<n, Tangential>(t, r, g, tangential);
  pull<n>(t, t.gather(springs.rolling(), row, gathered), with.dt, [&](std::size_t g) EPAFI_INLINED {
    prepare_rolling<n, Tangential, Rolling>(t, r, g, tangential, p, with.dt);
  });
  for (std::size_t g = 0; g < t.groups; ++g) {
    typename SphereTile<n>::Group& c = t.group[g];
    const auto stored = c.twice_stored, slipped = c.twice_slipped;  // of the friction springs
    settle_springs<n>(t, g, springs.rolling() + write, with.dt);
    c.twice_stored += stored, c.twice_slipped += slipped;
    r.moment[g] = within(c.load + r.dashpot[g] * r.spin[g], c.limit);
    c.viscous += (r.moment[g] - c.load).dot(r.spin[g]);
    c.load = r.friction[g];
  }
}

}  // namespace epafi
