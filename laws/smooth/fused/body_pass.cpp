#include "laws/smooth/fused/body_pass.h"

namespace epafi {

void predict_bodies(World& world, double lag, Lanes* late_spins, std::size_t begin, std::size_t end) {
  const std::span<BodyState> states = world.states();
  for (std::size_t i = begin; i < end; ++i) {
    const auto s = static_cast<Slot>(i);
    const double* v = world.velocity[s].data();
    double* to = reinterpret_cast<double*>(&states[i].predicted);  // a row of lanes would go through the stack
    for (int k = 0; k < 3; ++k) to[k] = v[k];
    if (late_spins != nullptr) {
      Vec3 late = world.angular_velocity[s];
      if (lag != 0.0 && world.is_movable(s)) late += world.apply_inverse_inertia(s, lag * world.torque[s]);
      late_spins[s] = Lanes{late.x(), late.y(), late.z(), 0.0};
    }
    if (lag == 0.0) continue;
    const Vec3 change = lag * world.acceleration(s);
    for (int k = 0; k < 3; ++k) to[k] += change[k];
  }
}

void unpack_bodies(World& world, SphereSum* sums, Lanes* moments, const std::uint8_t* touched, std::size_t begin,
                   std::size_t end) {
  const bool rotates = world.rotates();
  for (std::size_t s = begin; s < end; ++s) {
    double* from = reinterpret_cast<double*>(&sums[s - begin]);
    double* force = world.force[s].data();
    const bool add = touched != nullptr && touched[s] != 0;
    for (int k = 0; k < 3; ++k) force[k] = add ? force[k] + from[k] : from[k];
    if (rotates) {
      double* torque = world.torque[s].data();
      const double radius = world.states()[s].position[3];
      for (int k = 0; k < 3; ++k) {
        const double more = moments != nullptr ? moments[s - begin][k] : 0.0;
        torque[k] = (add ? torque[k] : 0.0) + (radius * from[3 + k] + more);
      }
    }
    for (int k = 0; k < 8; ++k) from[k] = 0.0;
    if (moments != nullptr) moments[s - begin] = Lanes{};
  }
}

bool has_plain_bodies(const World& world) {
  const Columns& c = world.columns();
  return !c.external_force && !c.anisotropy && !(c.rotation && c.orientation && c.free_turn);
}

bool are_plain(const World& world, std::size_t begin) {
  for (std::size_t i = begin; i < begin + 4; ++i) {
    const auto s = static_cast<Slot>(i);
    if (i >= world.size() || !world.is_movable(s) || (world.rotates() && !world.is_isotropic(s))) return false;
  }
  return true;
}

void BodyPass::begin_others(std::size_t from, std::size_t to, Extent& seen, Vec3& most_hurry) const {
  scheme.first_half(world, dt, from, to);
  predict_bodies(world, lag, late_spins, from, to);
  double sum = 0.0;
  for (std::size_t s = from; s < to; ++s) {
    if (hurry != nullptr) {
      const Vec3 way = double{hurry[s]} * world.velocity[s];
      most_hurry = most_hurry.cwiseMax(way.cwiseProduct(way));
    }
    if (!(world.inverse_mass[s] > 0.0)) continue;
    const double* x = world.position[s].data();
    for (int k = 0; k < 3; ++k)
      seen.low[k] = std::min(seen.low[k], x[k]), seen.high[k] = std::max(seen.high[k], x[k]), sum += 0.0 * x[k];
  }
  seen.finite = seen.finite && sum == 0.0;
}

void BodyPass::finish_others(std::size_t from, std::size_t to) const {
  unpack_bodies(world, sums + (from - begin), moments != nullptr ? moments + (from - begin) : nullptr, touched, from, to);
  scheme.second_half(world, dt, from, to);
  double sum = 0.0;
  for (std::size_t s = from; s < to; ++s) {
    const double *v = world.velocity[s].data(), *w = world.rotates() ? world.angular_velocity[s].data() : v;
    for (int k = 0; k < 3; ++k) sum += 0.0 * (v[k] + w[k]);
  }
  extent.finite = extent.finite && sum == 0.0;
}

}  // namespace epafi
