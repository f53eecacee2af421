// Sums over the bodies and overlaps of parts are the bits of the whole, however they are parted and ordered.
#include "engine/step/totals.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/step/energy.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

Body random_body(Random& random) {
  Body b;
  b.shape = random.uniform(0, 1) < 0.5 ? 0 : 1;
  b.mass = std::pow(10.0, random.uniform(-6, 2));
  b.inertia = Vec3::Constant(0.1 * b.mass);
  for (int k = 0; k < 3; ++k) {
    b.position[k] = random.uniform(-50, 50);
    b.velocity[k] = random.uniform(-1, 1) * std::pow(10.0, random.uniform(-8, 3));
    b.angular_velocity[k] = random.uniform(-10, 10);
  }
  return b;
}

std::array<double, 8> numbers(const BodyTotals& t) {
  return {t.kinetic.value(),     t.potential.value(),   t.mass.value(),    t.momentum[0].value(),
          t.momentum[1].value(), t.momentum[2].value(), t.momenta.value(), t.farthest};
}

}  // namespace

TEST_CASE("bodies in any order and parts have the same energies, momenta and masses, bit for bit", "[engine][totals]") {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    INFO(seed);
    Random random(3, seed);
    std::vector<Body> bodies;
    for (std::size_t k = 0; k < 700 + 400 * seed; ++k) bodies.push_back(random_body(random));
    const auto world_of = [](const std::vector<Body>& of) {
      World world(Columns{.rotation = true});
      world.gravity = Vec3(0.3, -1, -9.81);
      for (const Body& b : of) world.add(b);
      return world;
    };
    const World whole = world_of(bodies);
    const auto want = numbers(body_totals(whole));
    double kinetic = 0.0;
    for (Slot s = 0; s < whole.size(); ++s) kinetic += kinetic_energy(whole, s);
    CHECK(want[0] == Approx(kinetic).epsilon(1e-13));
    CHECK(kinetic_energy(whole) == want[0]);
    CHECK(potential_energy(whole) == want[1]);

    std::vector<Body> shuffled = bodies;
    for (std::size_t k = shuffled.size(); k > 1; --k)
      std::swap(shuffled[k - 1], shuffled[static_cast<std::size_t>(random.uniform(0, 1) * static_cast<double>(k))]);
    World part = world_of(shuffled);
    std::vector<int> rank(part.size());
    for (int& r : rank) r = static_cast<int>(random.uniform(0, 4));
    BodyTotals sum;
    for (int r = 0; r < 4; ++r) {
      part.owner.clear();
      for (const int of : rank) part.owner.push_back(of == r ? World::here : World::elsewhere);
      sum += body_totals(part);
    }
    CHECK(numbers(sum) == want);
  }
}

TEST_CASE("overlaps of random parts of the pairs have the sum, mean and largest of all, bit for bit",
          "[engine][totals]") {
  const auto radius = [](std::uint32_t shape) { return shape == 0 ? 0.1 : 0.013; };
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    INFO(seed);
    Random random(4, seed);
    World world(Columns{.rotation = true});
    for (int k = 0; k < 60; ++k) world.add(random_body(random));
    std::vector<std::tuple<Slot, Slot, ContactPoint>> points;
    std::vector<double> deepest;
    for (Slot a = 0; a < 60; ++a)
      for (Slot b = a + 1; b < 60; ++b) {
        const int count = static_cast<int>(random.uniform(0, 4));
        double deep = 0.0;
        for (int p = 0; p < count; ++p) {
          const double gap = random.uniform(-1, 0.5) * std::pow(10.0, random.uniform(-9, -2));
          points.push_back({a, b, {gap, Vec3::UnitZ(), Vec3::Zero(), 0.0, static_cast<Feature>(p), 0.0}});
          deep = std::max(deep, -gap);
        }
        if (deep > 0.0) deepest.push_back(deep);
      }
    ContactSet contacts;
    contacts.renew(points.size());
    for (std::size_t k = 0; k < points.size(); ++k)
      contacts.put(k, std::get<0>(points[k]), std::get<1>(points[k]), std::get<2>(points[k]), Vec3::Zero(),
                   Vec3::Zero());
    const ContactPieces pieces(world, contacts);
    const OverlapTotals all = overlap_totals(world, pieces, radius, [](Slot, Slot) { return true; });
    CHECK(all.pairs == deepest.size());
    CHECK(all.max == *std::ranges::max_element(deepest));
    CHECK(all.sum.value() == Approx(std::accumulate(deepest.begin(), deepest.end(), 0.0)).epsilon(1e-13));
    OverlapTotals sum;
    for (Slot part = 0; part < 3; ++part)
      sum += overlap_totals(world, pieces, radius, [&](Slot a, Slot b) { return (a * 7 + b) % 3 == part; });
    CHECK(sum.sum.value() == all.sum.value());
    CHECK(sum.pairs == all.pairs);
    CHECK(sum.max == all.max);
    CHECK(sum.max_relative == all.max_relative);
  }
}
