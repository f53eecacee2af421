#include "laws/smooth/rolling.h"

#include "engine/lanes/targets.h"
#include "laws/smooth/passes/tile_passes.h"

// Dashpots beside friction springs (laws/smooth/dashpot.h) and resistance to rolling (laws/smooth/rolling.h), behind
// the friction springs of a tile.

namespace epafi {

namespace {

/// Root and division only where some lane is beyond its limit.
template <int n, LaneVector V>
EPAFI_LANES VectorsOf<V> within(const VectorsOf<V>& load, const V& limit) {
  const V square = load.dot(load);
  if (less_bits<n>(limit * limit, square) == 0) return load;
  const MaskOf<V> over = square > limit * limit;
  const V length = sqrt(select(over, square, V{} + 1.0));
  return select(over, limit / length, V{} + 1.0) * load;
}

struct RollingPass {
  const RollingCall& call;

  template <int n>
  EPAFI_LANES void run() const {
    using V = typename LanesOf<n>::Real;
    auto& t = *static_cast<ContactTile<n>*>(call.tile);
    auto& r = *static_cast<TileRolling<n>*>(call.motion);
    const SphereNeeds& needs = call.passes->needs;
    if (needs.dashpots)
      each_group<n>(t, call, &PairRow::tangential, [&](std::size_t g, const V(&p)[PairRow::most]) EPAFI_INLINED {
        damp<n>(t, r, g, parameters_from<CoulombSpring::ParametersOf<V>>(p).damping);
      });
    else
      for (std::size_t g = 0; g < t.groups; ++g) r.friction[g] = within<n>(t.group[g].load, t.group[g].limit);
    if (needs.rolling) {
      each_group<n>(t, call, &PairRow::rolling, [&](std::size_t g, const V(&p)[PairRow::most]) EPAFI_INLINED {
        prepare<n>(t, r, g, {call.passes->law->rolling, p[0], p[1]});
        pull<n>(t, g, call.before, call.dt);
      });
      finish_pull<n>(t, call.dt);
      for (std::size_t g = 0; g < t.groups; ++g) finish<n>(t, r, g);
    } else {
      for (std::size_t g = 0; g < t.groups; ++g) t.group[g].load = r.friction[g];
    }
  }

 private:
  /// The friction spring pulls with t.load; it and its dashpot slide together.
  template <int n, class V>
  EPAFI_LANES void damp(ContactTile<n>& t, TileRolling<n>& r, std::size_t g, const V& damping) const {
    typename ContactTile<n>::Group& c = t.group[g];
    const V mobility = r.slip_mobility[g], dashpot = 2.0 * damping * sqrt(c.stiffness / mobility);
    const DamperStep<V> step{call.dt, call.lag * mobility};
    r.friction[g] = within<n>(c.load + damper_force(step, dashpot, c.stiffness, r.slip[g], c.slip), c.limit);
    c.viscous += (r.friction[g] - c.load).dot(r.slip[g]);
  }
  /// The rolling spring takes the place of the friction spring in the tile.
  template <int n, class V = typename LanesOf<n>::Real>
  EPAFI_LANES void prepare(ContactTile<n>& t, TileRolling<n>& r, std::size_t g,
                           const AnyRolling::ParametersOf<V>& p) const {
    typename ContactTile<n>::Group& c = t.group[g];
    RollingStepOf<V> step{c.normal_stiffness, c.grip, c.radius, r.inertia[g], V{}, V{}, call.dt};
    if (AnyRolling::stops_at_once(p)) {
      step.spin_inertia = 1.0 / r.inverse_inertia[g];
      step.spin = sqrt(r.spin[g].dot(r.spin[g]));
    }
    r.before[g] = c.energy;
    r.stored[g] = c.twice_stored;
    r.slipped[g] = c.twice_slipped;
    r.dashpot[g] = AnyRolling::damping(p, step);
    c.stiffness = AnyRolling::stiffness(p, step);
    c.limit = AnyRolling::limit(p, step);
    c.slip = r.turning[g];
  }
  template <int n>
  EPAFI_LANES void finish(ContactTile<n>& t, TileRolling<n>& r, std::size_t g) const {
    typename ContactTile<n>::Group& c = t.group[g];
    settle_springs<n>(t, g, call.now, call.dt);
    c.energy += r.before[g];
    c.twice_stored += r.stored[g];
    c.twice_slipped += r.slipped[g];
    const double lag = call.passes->law->rolling == AnyRolling::Type::constant ? 0.0 : call.lag;
    const DamperStep<typename LanesOf<n>::Real> step{call.dt, lag / r.inertia[g]};
    r.moment[g] = within<n>(c.load + damper_force(step, r.dashpot[g], c.stiffness, r.spin[g], c.slip), c.limit);
    c.viscous += (r.moment[g] - c.load).dot(r.spin[g]);
    c.load = r.friction[g];
  }
};

}  // namespace

void (*rolling_pass())(const RollingCall&) { return best_loop<RollingPass, RollingCall>(); }

}  // namespace epafi
