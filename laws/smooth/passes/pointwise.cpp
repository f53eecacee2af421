#include "engine/lanes/targets.h"
#include "laws/smooth/passes/tile_passes.h"

// Parts that have no lanes (laws of outside, rows of bristles) and contacts at located edges: one by one.

namespace epafi {

namespace {

struct PointwiseNormal {
  const NormalCall& call;

  template <int n>
  EPAFI_LANES void run() const {
    auto& t = *static_cast<ContactTile<n>*>(call.tile);
    const auto lanes = call.passes->lanes;
    if (lanes != nullptr) lanes(call);
    for (std::size_t k = 0; k < t.groups * n; ++k)
      if (lanes == nullptr || may_be_edge(t.overlap[k], t.group[k / n].approach[k % n], call.dt)) one<n>(t, k);
  }

 private:
  template <int n>
  EPAFI_LANES void one(ContactTile<n>& t, std::size_t k) const {
    const SmoothLaw& law = *call.passes->law;
    typename ContactTile<n>::Group& c = t.group[k / n];
    const std::size_t l = k % n, state = k * law.state;
    const auto pair = static_cast<std::size_t>(&call.row(t.row + k) - law.rows.data());
    ContactKinematics at{t.overlap[k], c.approach[l], 1.0 / c.inverse_mass[l], c.radius[l]};
    if (law.contact.area) at.area = c.area[l];
    at.middle_velocity = c.middle[l];
    at.step = {call.dt, call.lag * c.inverse_mass[l], call.ratio};
    const NormalResponse r = call.passes->one(law.numbers.data() + law.per_pair * pair, at, call.before + state,
                                              call.now + state, law.locates ? &call.dt : nullptr);
    c.force[l] = r.force;
    c.normal_stiffness[l] = r.stiffness;
    c.grip[l] = std::max(0.0, r.force + r.adhesion);
    c.lost[l] = r.lost;
    c.elastic[l] = r.energy;
    c.viscous[l] = c.late[l] = 0.0;
    if (call.push == nullptr) return;
    call.push[k] = r.force - r.elastic_force;
    const DashpotLoss<double> loss =
        dashpot_loss(at.step, call.push[k], call.push_before[k], at.approach_velocity, at.middle_velocity);
    c.viscous[l] = loss.power;
    c.late[l] = loss.late;
  }
};

struct PointwiseFriction {
  const TangentialCall& call;

  template <int n>
  EPAFI_LANES void run() const {
    using V = typename LanesOf<n>::Real;
    auto& t = *static_cast<ContactTile<n>*>(call.tile);
    t.rest_springs();
    for (std::size_t g = 0; g < t.groups; ++g) t.group[g].limit = V{} + infinity;  // they slide by themselves
    for (std::size_t k = 0; k < t.count; ++k) one<n>(t, k);
  }

 private:
  template <int n>
  EPAFI_LANES void one(ContactTile<n>& t, std::size_t k) const {
    const FrictionEvaluation& law = call.passes->law->friction;
    typename ContactTile<n>::Group& c = t.group[k / n];
    const std::size_t l = k % n;
    const Lanes& numbers = call.row(t.row + k).tangential;
    const SlipStep step{Vec3(t.x[k], t.y[k], t.z[k]), c.twist[l], call.dt * Vec3(c.slip.x[l], c.slip.y[l], c.slip.z[l]),
                        c.normal_stiffness[l], c.grip[l]};
    const double* const before = static_cast<const double*>(call.before) + k * law.memory;
    const double stored = law.energy(before);
    const FrictionResponse out = law.pull(numbers, step, before, static_cast<double*>(call.now) + k * law.memory);
    c.load.x[l] = out.load.x();
    c.load.y[l] = out.load.y();
    c.load.z[l] = out.load.z();
    c.energy[l] = 2.0 * stored;
    c.twice_stored[l] = 2.0 * out.energy;
    c.twice_slipped[l] = 2.0 * (out.work - (out.energy - stored));
  }
};

}  // namespace

void (*pointwise_normal())(const NormalCall&) { return best_loop<PointwiseNormal, NormalCall>(); }
void (*pointwise_friction())(const TangentialCall&) { return best_loop<PointwiseFriction, TangentialCall>(); }

}  // namespace epafi
