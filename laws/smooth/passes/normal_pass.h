/// @file normal_pass.h  A normal law as a pass. Only normal_laws.cpp, a line for each way of evaluation, sees it.
#pragma once
#include "engine/lanes/targets.h"
#include "laws/smooth/passes/tile_passes.h"

namespace epafi {

/// What a law says of the contacts of group g.
template <int n, bool remembers, class V = typename LanesOf<n>::Real>
EPAFI_LANES void write_response(const NormalCall& call, std::size_t g, const KinematicsOf<V>& at,
                                const ResponseOf<V>& r) {
  typename ContactTile<n>::Group& c = static_cast<ContactTile<n>*>(call.tile)->group[g];
  const V push = r.force - r.elastic_force;
  c.force = r.force;
  c.normal_stiffness = r.stiffness;
  c.grip = at_least<n>(r.force + r.adhesion, 0.0);
  if constexpr (remembers) c.lost = r.lost;
  if (call.push == nullptr) {
    c.viscous = c.late = V{};
  } else {
    V before;
    std::memcpy(&before, call.push_before + g * n, sizeof before);
    std::memcpy(call.push + g * n, &push, sizeof push);
    const DashpotLoss<V> loss = dashpot_loss(at.step, push, before, at.approach_velocity, at.middle_velocity);
    c.viscous = loss.power;
    c.late = loss.late;
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
      const typename ContactTile<n>::Group& c = t.group[g];
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
      write_response<n, RemembersNormal<Law>>(call, g, at, r);
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
