#include "laws/smooth/friction.h"
#include "engine/lanes/targets.h"
#include "laws/smooth/fused/tile_passes.h"

namespace epafi {

namespace {

/// Springs in fixed ratio to the normal stiffness.
struct CoulombPass {
  const TangentialCall& call;

  template <int n>
  EPAFI_LANES void run() const {
    using V = typename LanesOf<n>::Real;
    auto& t = *static_cast<SphereTile<n>*>(call.tile);
    const double dt = call.dt;
    each_group<n>(t, call, &PairRow::tangential, [&](std::size_t g, const V(&numbers)[PairRow::most]) EPAFI_INLINED {
      const auto p = parameters_from<CoulombSpring::ParametersOf<V>>(numbers);
      typename SphereTile<n>::Group& c = t.group[g];
      c.stiffness = CoulombSpring::stiffness(p, c.normal_stiffness);
      c.limit = p.friction * c.grip;
      pull<n>(t, g, call.before, dt);
    });
    finish_pull<n>(t, dt);
    for (std::size_t g = 0; g < t.groups; ++g) settle_springs<n>(t, g, call.now, dt);
  }
};

/// Rows of bristles, contact by contact.
struct BristlePass {
  const TangentialCall& call;

  template <int n>
  EPAFI_LANES void run() const {
    auto& t = *static_cast<SphereTile<n>*>(call.tile);
    t.rest_springs();
    for (std::size_t g = 0; g < t.groups; ++g) {
      typename SphereTile<n>::Group& c = t.group[g];
      using V = typename LanesOf<n>::Real;
      c.stiffness = c.limit = V{};
    }
    for (std::size_t k = 0; k < t.count; ++k) one<n>(t, k);
  }

 private:
  template <int n>
  EPAFI_LANES void one(SphereTile<n>& t, std::size_t k) const {
    typename SphereTile<n>::Group& c = t.group[k / n];
    const std::size_t l = k % n;
    const Lanes& row = call.rows[call.one_row ? 0 : t.row[k]].tangential;
    const MindlinDeresiewicz::Parameters p{row[0], row[1]};
    const SlipStep step{Vec3(t.x[k], t.y[k], t.z[k]), c.twist[l], call.dt * Vec3(c.slip.x[l], c.slip.y[l], c.slip.z[l]),
                        c.normal_stiffness[l], c.grip[l]};
    const Bristles& before = call.bristles_before[k].get();
    const double stored = energy_of(before);
    Bristles now;
    const FrictionResponse out = MindlinDeresiewicz::pull(p, step, before, now);
    c.stiffness[l] = MindlinDeresiewicz::stiffness(p, step.normal_stiffness);
    c.limit[l] = p.friction * step.normal_force;
    c.load.x[l] = out.load.x();
    c.load.y[l] = out.load.y();
    c.load.z[l] = out.load.z();
    c.twice_stored[l] = 2.0 * out.energy;
    c.twice_slipped[l] = 2.0 * (out.work - (out.energy - stored));
    if (!(call.dt > 0.0)) {  // no time passes: a contact that begins remembers how many bristles it has
      if (!(before.width > 0.0) && t.spring[k] != SphereSprings::unloaded) call.bristles_now[t.spring[k]].get() = now;
      return;
    }
    call.bristles_now[k].get() = now;
    call.now[k].load = Lanes{out.load.x(), out.load.y(), out.load.z(), 0.0};
  }
};

}  // namespace

void (*coulomb_pass())(const TangentialCall&) { return best_loop<CoulombPass, TangentialCall>(); }
void (*bristle_pass())(const TangentialCall&) { return best_loop<BristlePass, TangentialCall>(); }

}  // namespace epafi
