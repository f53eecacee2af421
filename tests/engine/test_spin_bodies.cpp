// Bodies that turn several at a time against those that turn one by one.
#include "engine/state/spin_bodies.h"

#include <bit>
#include <cmath>

#include "engine/lanes/targets.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

/// Free and held bodies, with one, two or three equal moments, slow and fast, some of which feel no torque.
World random_bodies(std::uint64_t seed) {
  Random random(seed, 0);
  const auto vector = [&] { return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
  World world(Columns{.rotation = true, .anisotropy = true});
  for (int k = 0; k < 37; ++k) {
    Body body;
    body.mass = k % 9 == 0 ? 0.0 : 1.0;
    body.inertia = Vec3(random.uniform(0.2, 2), random.uniform(0.2, 2), random.uniform(0.2, 2));
    const auto kind = static_cast<int>(random.bits() % 6);
    if (kind < 3) body.inertia[kind] = body.inertia[(kind + 1) % 3];
    if (kind == 3) body.inertia = Vec3::Constant(body.inertia.x());
    if (random.uniform() < 0.8) {
      body.orientation.vec() = vector();
      body.orientation.w() = random.uniform(-1, 1);
    }
    const double speed = std::pow(10.0, random.uniform(-6, 2));
    body.angular_velocity = random.uniform() < 0.2 ? Vec3(0, 0, speed) : Vec3(speed * vector());
    world.add(body);
    world.torque.back() = random.uniform() < 0.2 ? Vec3(Vec3::Zero()) : vector();
  }
  return world;
}

/// -0 and 0 are not the same.
bool same_bits(const double* a, const double* b, int n) {
  for (int k = 0; k < n; ++k)
    if (std::bit_cast<std::uint64_t>(a[k]) != std::bit_cast<std::uint64_t>(b[k])) return false;
  return true;
}

}  // namespace

TEST_CASE("bodies turned several at a time have the bits of those turned one by one", "[engine][rotation]") {
  for (const Target most : {Target::baseline, Target::avx2, Target::avx512}) {
    limit_target(most);
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      Random random(seed, 1);
      World several = random_bodies(seed), single = random_bodies(seed);
      const double dt = std::pow(10.0, random.uniform(-5, -1)), turn = seed % 3 == 0 ? 0.0 : dt;
      const std::size_t begin = random.bits() % 5, end = several.size() - random.bits() % 5;
      const int kicks = 1 + static_cast<int>(random.bits() % 2);
      for (int step = 0; step < 5; ++step) {
        spin_bodies(several, 0.5 * dt, kicks, turn, begin, end);
        for (std::size_t s = begin; s < end; ++s) {
          if (single.is_isotropic(static_cast<Slot>(s))) continue;
          for (int k = 0; k < kicks; ++k)
            single.apply_angular_impulse(static_cast<Slot>(s), 0.5 * dt * single.torque[s]);
          if (turn != 0.0) single.rotate(static_cast<Slot>(s), turn);
        }
      }
      bool same = true;
      for (Slot s = 0; s < single.size(); ++s)
        same = same && same_bits(several.orientation[s].coeffs().data(), single.orientation[s].coeffs().data(), 4) &&
               same_bits(several.angular_velocity[s].data(), single.angular_velocity[s].data(), 3) &&
               same_bits(several.angular_momentum[s].data(), single.angular_momentum[s].data(), 3);
      INFO("seed " << seed << ", target " << static_cast<int>(most));
      CHECK(same);
    }
  }
  limit_target(Target::avx512);
}
