/// @file normal_pass.h  A normal law as a pass. Only normal_laws.cpp, a line for each way of evaluation, sees it.
#pragma once
#include "engine/lanes/targets.h"
#include "laws/smooth/fused/tile_passes.h"

namespace epafi {

template <class Law>
struct NormalPass {
  const NormalCall& call;

  template <int n>
  EPAFI_LANES void run() const {
    using V = typename LanesOf<n>::Real;
    auto& t = *static_cast<SphereTile<n>*>(call.tile);
    each_group<n>(t, call, &PairRow::normal, [&](std::size_t g, const V(&p)[PairRow::most]) EPAFI_INLINED {
      typename SphereTile<n>::Group& c = t.group[g];
      KinematicsOf<V> at;
      at.overlap = t.column(t.overlap, g);
      at.approach_velocity = c.approach;
      at.effective_mass = 1.0 / c.inverse_mass;
      at.effective_radius = c.radius;
      at.middle_velocity = c.middle;
      at.step = {call.dt, call.lag * c.inverse_mass, call.ratio};
      V old{}, now{};
      if constexpr (RemembersNormal<Law>) std::memcpy(&old, call.before + g * n, sizeof old);
      const ResponseOf<V> r = !LaneLaw<Law> || (PowerParts<Law> && call.locates) ? lane_by_lane<n>(p, at, old, now)
                                                                                 : together<n>(p, at, old, now);
      if constexpr (RemembersNormal<Law>) {
        std::memcpy(call.now + g * n, &now, sizeof now);
        c.lost = r.lost;
      }
      c.force = r.force;
      c.normal_stiffness = r.stiffness;
      c.grip = at_least<n>(r.force + r.adhesion, 0.0);
      if (call.lag > 0.0) {
        const DashpotLoss<V> loss = viscous_loss(at, r, RemembersNormal<Law>);
        c.viscous = loss.power;
        c.late = loss.late;
      } else {
        c.viscous = (r.force - r.elastic_force) * at.approach_velocity;
      }
      if (call.tells_energy) c.elastic = r.energy;
    });
  }

 private:
  template <int n, class V>
  EPAFI_LANES static ResponseOf<V> together(const V (&p)[PairRow::most], const KinematicsOf<V>& at, const V& old,
                                            V& now) {
    if constexpr (!LaneLaw<Law>) {
      return {};
    } else if constexpr (RemembersNormal<Law>) {
      typename Law::template StateOf<V> next{};
      const ResponseOf<V> r = Law::respond(parameters_from<typename Law::template ParametersOf<V>>(p), at,
                                           typename Law::template StateOf<V>{old}, next);
      std::memcpy(&now, &next, sizeof now);
      return r;
    } else {
      return Law::respond(parameters_from<typename Law::template ParametersOf<V>>(p), at);
    }
  }
  template <int n, class V>
  EPAFI_LANES ResponseOf<V> lane_by_lane(const V (&p)[PairRow::most], const KinematicsOf<V>& at, const V& old,
                                         V& now) const {
    ResponseOf<V> out;
    for (std::size_t l = 0; l < n; ++l) {
      const double numbers[PairRow::most] = {p[0][l], p[1][l], p[2][l], p[3][l]};
      ContactKinematics c{at.overlap[l], at.approach_velocity[l], at.effective_mass[l], at.effective_radius[l]};
      c.middle_velocity = at.middle_velocity[l];
      c.step = {at.step.dt, at.step.half_mobility[l]};
      const double before = old[l];
      double next = 0.0;
      const NormalResponse r = respond_to<Law>(numbers, c, &before, &next, call.locates ? &call.dt : nullptr);
      out.force[l] = r.force;
      out.elastic_force[l] = r.elastic_force;
      out.stiffness[l] = r.stiffness;
      out.energy[l] = r.energy;
      out.adhesion[l] = r.adhesion;
      out.lost[l] = r.lost;
      out.dashpot[l] = r.dashpot;
      out.growth[l] = r.growth;
      out.share_before[l] = r.share_before;
      now[l] = next;
    }
    return out;
  }
};

template <class Law>
NormalEvaluation normal_evaluation() {
  if constexpr (fits_tiles<Law>)
    return {best_loop<NormalPass<Law>, NormalCall>(), respond_to<Law>};
  else
    return {nullptr, respond_to<Law>};
}

}  // namespace epafi
