// A box set down on a slope in smooth contact: what its elasticity does, and what it does not.
#include <cmath>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

struct Slope {
  double angle, mu, e, modulus;
  Vec3 size;
};

/// How far ahead of the rigid box, which slides from the start, at half the time and at the end, of 0.4 s [m/s].
std::pair<double, double> ahead_of_rigid(const Slope& s) {
  const double rigid = 9.81 * (std::sin(s.angle) - s.mu * std::cos(s.angle));
  const auto number = [](double x) { return std::to_string(x); };
  auto run =
      start_text("run = { duration = 0.4, time_step = \"auto\" }\nworld = { gravity = [" +
                 number(9.81 * std::sin(s.angle)) + ", 0, " + number(-9.81 * std::cos(s.angle)) + "] }\n" +
                 "material.m = { density = 1700, poissons_ratio = 0.3, youngs_modulus = " + number(s.modulus) +
                 " }\ncontact = { method = \"smooth\", restitution = " + number(s.e) + ", friction = " + number(s.mu) +
                 " }\n[[body]]\nname = \"slope\"\nmaterial = \"m\"\n" +
                 "shape = { half_space = { normal = [0, 0, 1] } }\nfixed = true\n[[body]]\nname = \"box\"\n" +
                 "material = \"m\"\nshape = { box = { size = [" + number(s.size.x()) + ", " + number(s.size.y()) +
                 ", " + number(s.size.z()) + "] } }\nposition = [0, 0, " + number(0.5 * s.size.z()) +
                 "]\n[[measure]]\nname = \"v\"\nkind = \"velocity\"\nbody = \"box\"\n");
  const auto ahead = [&] { return run.last("v", "x") - rigid * run.simulation().world.time; };
  run.advance_to(run.assembly->steps / 2);
  const double middle = ahead();
  run.advance_to(0);
  return {middle, ahead()};
}

}  // namespace

TEST_CASE("a box set down on a slope is ahead by what its springs give, and slides as a rigid one from then on",
          "[physics][slide]") {
  for (std::uint32_t draw = 0; draw < 8; ++draw) {
    Random random(23, draw);
    Slope s{random.uniform(0.4, 0.7), 0.0, random.uniform(0.1, 0.5), std::pow(10.0, random.uniform(6.5, 7.5)),
            Vec3(random.uniform(0.4, 0.8), random.uniform(0.4, 0.8), random.uniform(0.08, 0.15))};
    s.mu = random.uniform(0.4, 0.8) * std::tan(s.angle);
    INFO("draw " << draw << ": angle " << s.angle << ", mu " << s.mu << ", e " << s.e << ", E " << s.modulus);
    const auto [middle, end] = ahead_of_rigid(s);
    CHECK(end == Approx(middle).epsilon(0.05));  // e = 0.1: the last percents of the overlap take long
    Slope stiffer = s;
    stiffer.modulus *= 8.0;
    CHECK(end > 0.0);
    CHECK(ahead_of_rigid(stiffer).second == Approx(0.5 * end).epsilon(0.01));
  }
}
