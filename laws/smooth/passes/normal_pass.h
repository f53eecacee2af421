/// @file normal_pass.h  A normal law as a pass. Only normal_laws.cpp, a line for each way of evaluation, sees it.
#pragma once
#include "engine/lanes/targets.h"
#include "laws/smooth/passes/tile_passes.h"

namespace epafi {

/// What a law says of the contacts of a group.
template <int n, bool remembers, class V = typename LanesOf<n>::Real>
EPAFI_LANES void write_response(const NormalCall& call, typename ContactTile<n>::Group& c, const KinematicsOf<V>& at,
                                const ResponseOf<V>& r) {
  c.force = r.force;
  c.normal_stiffness = r.stiffness;
  c.grip = at_least<n>(r.force + r.adhesion, 0.0);
  if constexpr (remembers) c.lost = r.lost;
  if (call.lag > 0.0) {
    const DashpotLoss<V> loss = viscous_loss(at, r, remembers);
    c.viscous = loss.power;
    c.late = loss.late;
  } else {
    c.viscous = (r.force - r.elastic_force) * at.approach_velocity;
  }
  if (call.tells_energy) c.elastic = r.energy;
}

template <class Law>
struct NormalPass {
  const NormalCall& call;

  template <int n>
  EPAFI_LANES void run() const {
    using V = typename LanesOf<n>::Real;
    auto& t = *static_cast<ContactTile<n>*>(call.tile);
    each_group<n>(t, call, &PairRow::normal, [&](std::size_t g, const V(&p)[PairRow::most]) EPAFI_INLINED {
      typename ContactTile<n>::Group& c = t.group[g];
      KinematicsOf<V> at;
      at.overlap = t.column(t.overlap, g);
      at.approach_velocity = c.approach;
      at.effective_mass = 1.0 / c.inverse_mass;
      at.effective_radius = c.radius;
      at.middle_velocity = c.middle;
      at.step = {call.dt, call.lag * c.inverse_mass, call.ratio};
      if constexpr (Law::needs.area) at.area = c.area;
      ResponseOf<V> r;
      const auto row = parameters_from<typename Law::template ParametersOf<V>>(p);
      if constexpr (RemembersNormal<Law>) {
        typename Law::template StateOf<V> old, now{};
        static_assert(sizeof old == sizeof(V));
        std::memcpy(static_cast<void*>(&old), call.before + g * n, sizeof old);
        r = Law::respond(row, at, old, now);
        std::memcpy(call.now + g * n, &now, sizeof now);
      } else {
        r = Law::respond(row, at);
      }
      write_response<n, RemembersNormal<Law>>(call, c, at, r);
    });
  }
};

template <class Law>
NormalEvaluation normal_evaluation() {
  if constexpr (LaneLaw<Law>)
    return {best_loop<NormalPass<Law>, NormalCall>(), respond_to<Law>};
  else
    return {nullptr, respond_to<Law>};
}

}  // namespace epafi
