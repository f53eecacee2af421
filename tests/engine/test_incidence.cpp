#include "engine/state/incidence.h"

#include "engine/state/held_loads.h"
#include "engine/threads/parallel.h"
#include "engine/threads/parallel_order.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"

using namespace epafi;

namespace {

struct Case {
  World world{Columns{.rotation = true}};
  ContactSet contacts;
};

Case random_case(std::uint64_t seed, Slot bodies) {
  Case c;
  Random random(seed, 1);
  const auto vec = [&] { return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
  for (Slot s = 0; s < bodies; ++s) {
    Body b;
    b.position = vec();
    b.mass = s % 9 == 4 ? 0.0 : 1.0;
    b.inertia = Vec3(1, 1, 1);
    c.world.add(b);
  }
  c.contacts.with_moment = seed % 2 == 1;
  for (Slot a = 0; a < bodies; ++a)
    for (Slot d = 0; d < bodies; ++d) {
      if (a == d || random.uniform() > 8.0 / bodies || a % 17 == 3) continue;  // some bodies are A of nothing
      ContactPoint p;
      p.arm = vec();
      c.contacts.append(a, d, p);
      c.contacts.force.push_back(vec());
      if (c.contacts.with_moment) c.contacts.moment.push_back(vec());
    }
  return c;
}

}  // namespace

TEST_CASE("each body meets its contacts as A, then as B, both in canonical order", "[engine][incidence]") {
  const support::KeepThreads keep;
  for (Slot bodies : {0u, 1u, 2u, 50u, 300u, 1500u}) {  // of the last 12 000 contacts, which are shared out
    set_thread_count(bodies > 300 ? 3 : keep.before);
    const Case c = random_case(2, bodies);
    Incidence incidence;
    incidence.build(c.contacts, bodies);
    for (Slot s = 0; s < bodies; ++s) {
      std::vector<std::pair<std::uint32_t, double>> expected, found;
      for (std::uint32_t k = 0; k < c.contacts.size(); ++k)
        if (c.contacts.a[k] == s) expected.emplace_back(k, 1.0);
      for (std::uint32_t k = 0; k < c.contacts.size(); ++k)
        if (c.contacts.b[k] == s) expected.emplace_back(k, -1.0);
      incidence.for_each(s, [&](std::uint32_t k, double sign) { found.emplace_back(k, sign); });
      REQUIRE((found == expected));
      REQUIRE(incidence.count(s) == expected.size());
    }
  }
}

TEST_CASE("gathered forces and torques are the direct sums; fixed bodies take none", "[engine][incidence]") {
  for (std::uint64_t seed : {1u, 2u}) {
    Case c = random_case(seed, 200);
    Incidence incidence;
    incidence.build(c.contacts, 200);
    gather_forces(c.contacts, incidence, c.world);
    std::vector<Vec3> force(200, Vec3::Zero()), torque(200, Vec3::Zero());
    for (std::size_t k = 0; k < c.contacts.size(); ++k) {
      const Slot a = c.contacts.a[k], b = c.contacts.b[k];
      const Vec3 f = c.contacts.force[k], point = c.world.position[a] + c.contacts.arm[k];
      const Vec3 moment = c.contacts.with_moment ? c.contacts.moment[k] : Vec3(Vec3::Zero());
      force[a] += f;
      force[b] -= f;
      torque[a] += (point - c.world.position[a]).cross(f) + moment;
      torque[b] -= (point - c.world.position[b]).cross(f) + moment;
    }
    for (Slot s = 0; s < 200; ++s) {
      const double free = c.world.is_movable(s) ? 1.0 : 0.0;
      // some 16 terms of size 2: 16 * 2 * 1.1e-16 and as much for the other order of summation
      CHECK((c.world.force[s] - free * force[s]).norm() < 1e-14);
      CHECK((c.world.torque[s] - free * torque[s]).norm() < 1e-13);
    }
  }
}

TEST_CASE("gathered sums are the same bits for every thread count", "[engine][incidence][threads]") {
  const support::KeepThreads keep;
  std::string reference;
  for (int threads : {1, 2, 3, 4, 7, 8}) {
    set_thread_count(threads);
    Case c = random_case(3, 1500);
    Incidence incidence;
    incidence.build(c.contacts, 1500);
    gather_forces(c.contacts, incidence, c.world);
    parallel_copy(c.world.force, c.world.velocity);  // for the hash
    parallel_copy(c.world.torque, c.world.angular_velocity);
    if (threads == 1) reference = state_hash(c.world);
    CHECK(state_hash(c.world) == reference);
  }
}

TEST_CASE("of few bodies with contacts each is met once, and their sums are the same bits as those of all",
          "[engine][incidence][threads]") {
  const support::KeepThreads keep;
  for (int threads : {1, 2, 3, 8}) {
    set_thread_count(threads);
    for (Slot bodies : {1u, 50u, 1500u, 3000u}) {
      Case c = random_case(bodies, bodies);
      std::vector<std::uint8_t> named(bodies, 0), written(bodies, 0);
      for (std::size_t k = 0; k < c.contacts.size(); ++k) named[c.contacts.a[k]] = named[c.contacts.b[k]] = 1;
      Incidence incidence;
      incidence.build(c.contacts, bodies);
      gather_forces(c.contacts, incidence, c.world);
      const std::vector<Vec3> force = c.world.force, torque = c.world.torque;
      for (Slot s = 0; s < bodies; ++s) c.world.force[s] = c.world.torque[s] = Vec3::Constant(7.0);
      TouchedBodies touched;
      std::vector<int> met(bodies, 0);
      touched.build(c.contacts, c.world, [&](Slot s) { ++met[s]; });
      gather_forces(c.contacts, touched, c.world, written);
      CHECK(std::equal(met.begin(), met.end(), named.begin(), named.end()));
      CHECK(written == named);
      for (Slot s = 0; s < bodies; ++s) {
        const bool as_all = c.world.force[s] == force[s] && c.world.torque[s] == torque[s];
        const bool left = c.world.force[s] == Vec3::Constant(7.0) && c.world.torque[s] == Vec3::Constant(7.0);
        REQUIRE((named[s] != 0 ? as_all : left));
      }
    }
  }
}

TEST_CASE("loads of held bodies summed in random parts have the bits of gathered forces", "[engine][incidence]") {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    INFO(seed);
    Case c = random_case(seed, 200);
    World world(Columns{.rotation = true, .held_force = true});
    std::vector<Slot> held;
    for (Slot s = 0; s < 200; ++s) {
      Body b;
      b.position = c.world.position[s];
      b.mass = c.world.is_movable(s) ? 1.0 : 0.0;
      b.inertia = Vec3(1, 1, 1);
      world.add(b);
      if (!world.is_movable(s)) held.push_back(s);
    }
    Incidence incidence;
    incidence.build(c.contacts, 200);
    gather_forces(c.contacts, incidence, world);
    std::vector<HeldLoad> sum(held.size());
    for (Slot part = 0; part < 3; ++part) {
      const auto counts = [&](Slot a, Slot b) { return (a * 7 + b * (seed + 1)) % 3 == part; };
      const std::vector<HeldLoad> more = held_loads(world, c.contacts, held, counts);
      for (std::size_t h = 0; h < held.size(); ++h) sum[h] += more[h];
    }
    for (std::size_t h = 0; h < held.size(); ++h)
      for (int k = 0; k < 3; ++k) {
        CHECK(sum[h].sums[static_cast<std::size_t>(k)].value() == world.force[held[h]][k]);
        CHECK(sum[h].sums[static_cast<std::size_t>(3 + k)].value() == world.torque[held[h]][k]);
      }
  }
}
