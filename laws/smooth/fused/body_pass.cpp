#include "laws/smooth/fused/body_pass.h"

namespace epafi {

void pack_bodies(const World& world, double lag, SphereState* states, Lanes* late_spins, std::size_t begin,
                 std::size_t end) {
  const bool rotates = world.rotates();
  static constexpr double still[3] = {0.0, 0.0, 0.0};
  for (std::size_t i = begin; i < end; ++i) {
    const auto s = static_cast<Slot>(i);
    const double *x = world.position[s].data(), *v = world.velocity[s].data(),
                 *w = rotates ? world.angular_velocity[s].data() : still;
    double* to = reinterpret_cast<double*>(&states[i]);  // number by number: a row of lanes would go through the stack
    for (int k = 0; k < 3; ++k) to[k] = x[k], to[4 + k] = v[k], to[8 + k] = w[k], to[12 + k] = v[k];
    if (late_spins != nullptr) {
      Vec3 late = world.angular_velocity[s];
      if (lag != 0.0 && world.is_movable(s)) late += world.apply_inverse_inertia(s, lag * world.torque[s]);
      late_spins[s] = Lanes{late.x(), late.y(), late.z(), 0.0};
    }
    if (lag == 0.0) continue;
    const Vec3 change = lag * world.acceleration(s);
    for (int k = 0; k < 3; ++k) to[12 + k] += change[k];
  }
}

void unpack_bodies(World& world, const SphereState* states, SphereSum* sums, Lanes* moments,
                   const std::uint8_t* touched, std::size_t begin, std::size_t end) {
  const bool rotates = world.rotates();
  for (std::size_t s = begin; s < end; ++s) {
    double* from = reinterpret_cast<double*>(&sums[s - begin]);
    double* force = world.force[s].data();
    const bool add = touched != nullptr && touched[s] != 0;
    for (int k = 0; k < 3; ++k) force[k] = add ? force[k] + from[k] : from[k];
    if (rotates) {
      double* torque = world.torque[s].data();
      const double radius = states[s].position[3];
      for (int k = 0; k < 3; ++k) {
        const double more = moments != nullptr ? moments[s - begin][k] : 0.0;
        torque[k] = (add ? torque[k] : 0.0) + (radius * from[4 + k] + more);
      }
    }
    for (int k = 0; k < 8; ++k) from[k] = 0.0;
    if (moments != nullptr) moments[s - begin] = Lanes{};
  }
}

void show_motion(World& world, const SphereState* states, std::size_t begin, std::size_t end) {
  const bool rotates = world.rotates();
  for (std::size_t s = begin; s < end; ++s) {
    const double* from = reinterpret_cast<const double*>(&states[s]);
    double *x = world.position[s].data(), *v = world.velocity[s].data();
    for (int k = 0; k < 3; ++k) x[k] = from[k], v[k] = from[4 + k];
    if (!rotates) continue;
    double* w = world.angular_velocity[s].data();
    for (int k = 0; k < 3; ++k) w[k] = from[8 + k];
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

void BodyPass::begin_others(std::size_t from, std::size_t to, Extent& seen) const {
  scheme.first_half(world, dt, from, to);
  pack_bodies(world, lag, states, late_spins, from, to);
  double sum = 0.0;
  for (std::size_t s = from; s < to; ++s) {
    if (!(world.inverse_mass[s] > 0.0)) continue;
    const double* x = world.position[s].data();
    for (int k = 0; k < 3; ++k)
      seen.low[k] = std::min(seen.low[k], x[k]), seen.high[k] = std::max(seen.high[k], x[k]), sum += 0.0 * x[k];
  }
  seen.finite = seen.finite && sum == 0.0;
}

void BodyPass::measure_others(std::size_t from, std::size_t to, Vec3& most) const {
  for (std::size_t s = from; s < to; ++s) {
    const Vec3 way = hurry[s] * world.velocity[s];
    most = most.cwiseMax(way.cwiseProduct(way));
  }
}

void BodyPass::finish_others(std::size_t from, std::size_t to) const {
  unpack_bodies(world, states, sums + (from - begin), moments != nullptr ? moments + (from - begin) : nullptr, touched,
                from, to);
  scheme.second_half(world, dt, from, to);
  double sum = 0.0;
  for (std::size_t s = from; s < to; ++s) {
    const double *v = world.velocity[s].data(), *w = world.rotates() ? world.angular_velocity[s].data() : v;
    for (int k = 0; k < 3; ++k) sum += 0.0 * (v[k] + w[k]);
  }
  extent.finite = extent.finite && sum == 0.0;
}

}  // namespace epafi
