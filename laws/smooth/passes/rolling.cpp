#include <algorithm>
#include <array>

#include "engine/lanes/targets.h"
#include "laws/smooth/friction.h"
#include "laws/smooth/fused/tile_passes.h"

// Dashpots beside friction springs (laws/smooth/dashpot.h) and resistance to rolling (laws/smooth/rolling.h), behind
// the friction springs of a tile.

namespace epafi {

namespace {

/// Motion and loads of the contacts of a tile.
template <int n>
struct SphereRolling {
  using V = typename LanesOf<n>::Real;
  using V3 = VectorsOf<V>;
  static constexpr std::size_t size = SphereTile<n>::size;
  V3 slip[size], spin[size];        ///< velocities at the time of the detection [m/s], [rad/s]
  V3 turning[size];                 ///< against each other, in the middle of the step [rad/s]
  V slip_mobility[size];            ///< [1/kg]
  V inertia[size];                  ///< about the contact [kg m^2]
  V inverse_inertia[size];          ///< sum of those about the centres [1/(kg m^2)]
  V dashpot[size];                  ///< against rolling [N m s]
  V3 friction[size], moment[size];  ///< on A [N], [N m]
  V stored[size], slipped[size];    ///< twice those of the friction springs [J]
};

/// Root and division only where some lane is beyond its limit.
template <int n, LaneVector V>
EPAFI_LANES VectorsOf<V> within(const VectorsOf<V>& load, const V& limit) {
  const V square = load.dot(load);
  if (less_bits<n>(limit * limit, square) == 0) return load;
  const MaskOf<V> over = square > limit * limit;
  const V length = sqrt(select(over, square, V{} + 1.0));
  return select(over, limit / length, V{} + 1.0) * load;
}

template <LaneVector V>
EPAFI_LANES VectorsOf<V> in_plane(const VectorsOf<V>& x, const VectorsOf<V>& normal) {
  return x - x.dot(normal) * normal;
}

/// From the centre of a body to a contact of its ball, whose centre is at `offset` [m^2].
EPAFI_LANES double square_of_arm(const Vec3& offset, double arm, const std::array<double, 3>& normal) {
  double square = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double x = offset[k] + arm * normal[static_cast<std::size_t>(k)];
    square += x * x;
  }
  return square;
}

/// Motion and mobility of one side of n contacts.
template <int n>
struct SphereSide {
  using V = typename LanesOf<n>::Real;
  VectorsOf<V> late_spin{};
  V inverse_inertia{}, slip_mobility{}, rolling_mobility{};

  /// place(lane): of the sphere; normal: from it to the other one.
  template <class Place>
  EPAFI_LANES void read(const SphereArrays& with, const Place& place, const V& radius, const V& lever,
                        const VectorsOf<V>& normal) {
    read_columns([&](int l) EPAFI_INLINED { return row<n>(with.late_spin(place(l))); }, late_spin.x, late_spin.y,
                 late_spin.z, inverse_inertia);
    V inverse_mass{};
    for (int l = 0; l < n; ++l) inverse_mass[l] = with.state(place(l)).velocity[3];
    const V arm = radius * lever;
    V square = arm * arm;
    if (with.offsets != nullptr) [[unlikely]]
      for (int l = 0; l < n; ++l)
        if (place(l).slot() < with.balls)
          square[l] = square_of_arm(with.offsets[place(l).slot()], arm[l], {normal.x[l], normal.y[l], normal.z[l]});
    const V turning = square * inverse_inertia;
    slip_mobility = inverse_mass + turning;
    rolling_mobility = inverse_inertia * inverse_mass / at_least<n>(slip_mobility, 1e-300);  // of a held ball 0
  }
};

template <int n>
EPAFI_LANES void find_rolling(const SphereTile<n>& t, SphereRolling<n>& r, std::size_t g, const RollingCall& call) {
  const SphereArrays& with = *call.arrays;
  using V = typename LanesOf<n>::Real;
  const SpherePlaces* bodies = t.bodies + g * n;
  const typename SphereTile<n>::Group& c = t.group[g];
  const VectorsOf<V> normal = t.normal(g);
  SphereSide<n> a, b;
  a.read(
      with, [&](int l) EPAFI_INLINED { return bodies[l].a; }, c.radius_a, c.lever, normal);
  if (!call.wall)
    b.read(
        with, [&](int l) EPAFI_INLINED { return bodies[l].b; }, c.radius_b, c.lever, -normal);
  if (with.passes->needs.dashpots) {
    VectorsOf<V> velocity = -c.nearer;
    if (call.periodic && !call.wall) {  // the flow of a deforming cell comes on top
      const V length = t.column(t.distance, g);
      const Lanes& rate = with.strain_rate;
      velocity = velocity +
                 VectorsOf<V>{rate[0] * length * normal.x, rate[1] * length * normal.y, rate[2] * length * normal.z};
    }
    const VectorsOf<V> turning = c.lever * (c.radius_a * a.late_spin + c.radius_b * b.late_spin);
    r.slip[g] = in_plane(velocity, normal) - turning.cross(normal);
    r.slip_mobility[g] = a.slip_mobility + b.slip_mobility;
  }
  if (!with.passes->needs.rolling) return;
  r.spin[g] = in_plane(b.late_spin - a.late_spin, normal);
  r.turning[g] = in_plane(c.turning, normal);
  r.inertia[g] = 1.0 / (a.rolling_mobility + b.rolling_mobility);
  r.inverse_inertia[g] = a.inverse_inertia + b.inverse_inertia;
}

/// Adds the moments to the sums as add_forces does the forces; of B to records where it lies in another block.
template <int n>
EPAFI_LANES void add_moments(const SphereTile<n>& t, const SphereRolling<n>& r, std::size_t g,
                             const RollingCall& call) {
  const SphereArrays& with = *call.arrays;
  SphereBlocks::Block& block = *call.block;
  const SphereSprings::Places at = call.at;
  using V = typename LanesOf<n>::Real;
  const VectorsOf<V>& moment = r.moment[g];
  RowOf<n> rows[n];
  write_rows(moment.x, moment.y, moment.z, V{}, rows);
  const SpherePlaces* bodies = t.bodies + g * n;
  for (std::size_t l = 0; l < n && g * n + l < t.count; ++l) {
    Lanes& a = with.moment(bodies[l].a);
    store<n>(a, row<n>(a) + rows[l]);
    if (call.across) store<n>(block.record_moments[at.record + g * n + l], -rows[l]);
    if (call.wall || call.across) continue;
    Lanes& b = with.moment(bodies[l].b);
    store<n>(b, row<n>(b) - rows[l]);
  }
}

/// Stores the loads of the contacts of a tile for observers.
template <int n>
[[gnu::noinline]] void tell_loads(const SphereTile<n>& t, const SphereRolling<n>& r, const RollingCall& call) {
  SphereLoads* const loads = call.block->springs.loads();
  for (std::size_t k = 0; k < t.count; ++k) {
    const auto row_of = [at = k / n, l = k % n](const auto* x) {
      return Lanes{x[at].x[l], x[at].y[l], x[at].z[l], 0.0};
    };
    SphereLoads& now = loads[call.dt > 0.0 ? call.at.write + k : t.spring[k]];
    now.friction = row_of(r.friction);
    now.moment = call.arrays->passes->needs.rolling ? row_of(r.moment) : Lanes{};
  }
}

struct RollingPass {
  const RollingCall& call;

  template <int n>
  EPAFI_LANES void run() const {
    using V = typename LanesOf<n>::Real;
    auto& t = *static_cast<SphereTile<n>*>(call.tile);
    SphereRolling<n> r;
    for (std::size_t g = 0; g < t.groups; ++g) find_rolling<n>(t, r, g, call);
    if (call.arrays->passes->needs.dashpots)
      each_group<n>(t, call, &PairRow::tangential, [&](std::size_t g, const V(&p)[PairRow::most]) EPAFI_INLINED {
        damp<n>(t, r, g, parameters_from<CoulombSpring::ParametersOf<V>>(p).damping);
      });
    else
      for (std::size_t g = 0; g < t.groups; ++g) r.friction[g] = within<n>(t.group[g].load, t.group[g].limit);
    if (call.arrays->passes->needs.rolling) {
      each_group<n>(t, call, &PairRow::rolling, [&](std::size_t g, const V(&p)[PairRow::most]) EPAFI_INLINED {
        prepare<n>(t, r, g, {call.type, p[0], p[1]});
        pull<n>(t, g, call.before, call.dt);
      });
      finish_pull<n>(t, call.dt);
      for (std::size_t g = 0; g < t.groups; ++g) finish<n>(t, r, g);
      for (std::size_t g = 0; g < t.groups; ++g) add_moments<n>(t, r, g, call);
    } else {
      for (std::size_t g = 0; g < t.groups; ++g) t.group[g].load = r.friction[g];
    }
    if (call.arrays->tells_loads()) tell_loads<n>(t, r, call);
  }

 private:
  /// The friction spring pulls with t.load; it and its dashpot slide together.
  template <int n, class V>
  EPAFI_LANES void damp(SphereTile<n>& t, SphereRolling<n>& r, std::size_t g, const V& damping) const {
    typename SphereTile<n>::Group& c = t.group[g];
    const V mobility = r.slip_mobility[g], dashpot = 2.0 * damping * sqrt(c.stiffness / mobility);
    const DamperStep<V> step{call.dt, call.arrays->lag * mobility};
    r.friction[g] = within<n>(c.load + damper_force(step, dashpot, c.stiffness, r.slip[g], c.slip), c.limit);
    c.viscous += (r.friction[g] - c.load).dot(r.slip[g]);
  }
  /// The rolling spring takes the place of the friction spring in the tile.
  template <int n, class V = typename LanesOf<n>::Real>
  EPAFI_LANES void prepare(SphereTile<n>& t, SphereRolling<n>& r, std::size_t g,
                           const AnyRolling::ParametersOf<V>& p) const {
    typename SphereTile<n>::Group& c = t.group[g];
    RollingStepOf<V> step{c.normal_stiffness, c.grip, c.radius, r.inertia[g], V{}, V{}, call.dt};
    if (AnyRolling::stops_at_once(p)) {
      step.spin_inertia = 1.0 / r.inverse_inertia[g];
      step.spin = sqrt(r.spin[g].dot(r.spin[g]));
    }
    r.stored[g] = c.twice_stored;
    r.slipped[g] = c.twice_slipped;
    r.dashpot[g] = AnyRolling::damping(p, step);
    c.stiffness = AnyRolling::stiffness(p, step);
    c.limit = AnyRolling::limit(p, step);
    c.slip = r.turning[g];
  }
  template <int n>
  EPAFI_LANES void finish(SphereTile<n>& t, SphereRolling<n>& r, std::size_t g) const {
    typename SphereTile<n>::Group& c = t.group[g];
    settle_springs<n>(t, g, call.now, call.dt);
    c.twice_stored += r.stored[g];
    c.twice_slipped += r.slipped[g];
    const double lag = call.type == AnyRolling::Type::constant ? 0.0 : call.arrays->lag;
    const DamperStep<typename LanesOf<n>::Real> step{call.dt, lag / r.inertia[g]};
    r.moment[g] = within<n>(c.load + damper_force(step, r.dashpot[g], c.stiffness, r.spin[g], c.slip), c.limit);
    c.viscous += (r.moment[g] - c.load).dot(r.spin[g]);
    c.load = r.friction[g];
  }
};

}  // namespace

void (*rolling_pass())(const RollingCall&) { return best_loop<RollingPass, RollingCall>(); }

}  // namespace epafi
