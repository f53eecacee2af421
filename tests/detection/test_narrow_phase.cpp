#include "detection/narrow/narrow_phase.h"

#include <algorithm>
#include <cstring>
#include <map>

#include "engine/lanes/targets.h"
#include "engine/threads/parallel.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/support/polyhedra.h"

using namespace epafi;

namespace {

struct Scene {
  ShapeStore shapes;
  World world{Columns{.rotation = true}};
  PairList pairs;

  template <class S>
  Slot add(S shape, const Vec3& position, const Quat& turn = Quat(1, 0, 0, 0)) {
    Body body;
    body.position = position;
    body.orientation = turn;
    body.mass = 1.0;
    body.inertia = Vec3::Ones();
    body.shape = shapes.add(std::move(shape)).packed;
    return world.slot_of(world.add(body));
  }
  void pair_all() {
    pairs.pairs.clear();
    for (Slot a = 0; a < world.size(); ++a) {
      for (Slot b = a + 1; b < world.size(); ++b) pairs.pairs.push_back({a, b});
    }
    ++pairs.generation;
  }
  ContactSet contacts(double reach = 0.0, bool curvature = true) {
    pair_all();
    BatchNarrowPhase narrow(shapes, reach, curvature);
    ContactSet out;
    narrow.collide(world, pairs, out);
    return out;
  }
};

const HalfSpace ground{Vec3::UnitZ()};

Scene mixed(std::uint64_t seed, int bodies) {
  Scene s;
  Random random(seed, 0);
  s.add(ground, {0, 0, 0});
  for (int k = 0; k < bodies; ++k) {
    const Vec3 x(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(0.2, 4));
    const Quat turn = testing::random_turn(random);
    switch (k % 6) {
      case 0:
        s.add(Sphere{random.uniform(0.2, 0.5)}, x, turn);
        break;
      case 1:
        s.add(Box(Vec3(0.3, 0.2, random.uniform(0.1, 0.5))), x, turn);
        break;
      case 2:
        s.add(support::random_hull(random, 14, Vec3::Constant(0.4)), x, turn);
        break;
      case 3:
        s.add(Capsule(0.2, random.uniform(0, 1)), x, turn);
        break;
      case 4:
        s.add(Cylinder(0.25, random.uniform(0.2, 1)), x, turn);
        break;
      default:
        s.add(Ellipsoid(Vec3(0.4, 0.3, 0.2)), x, turn);
    }
  }
  return s;
}

bool same_bits(const ContactSet& x, const ContactSet& y) {
  const auto equal = [](const auto& p, const auto& q) {
    return p.size() == q.size() && (p.empty() || std::memcmp(p.data(), q.data(), p.size() * sizeof(p[0])) == 0);
  };
  return equal(x.a, y.a) && equal(x.b, y.b) && equal(x.feature, y.feature) && equal(x.gap, y.gap) &&
         equal(x.normal, y.normal) && equal(x.arm, y.arm) && equal(x.effective_radius, y.effective_radius);
}

}  // namespace

TEST_CASE("two spheres: gap, normal, point and R* as written", "[detection][narrow]") {
  Scene s;
  s.add(Sphere{1}, {1, 0, 0});
  s.add(Sphere{2}, {1, 0, 2.5});
  const auto c = s.contacts();
  REQUIRE(c.size() == 1);
  CHECK(c.gap[0] == -0.5);
  CHECK(c.normal[0] == Vec3(0, 0, 1));
  CHECK((c.arm[0] - Vec3(0, 0, 2.5 / 3)).norm() <
        1e-15);  // the line of centres, 2.5 long, divided like the radii 1 : 2
  CHECK(c.effective_radius[0] == Approx(2.0 / 3.0).epsilon(1e-15));
  // A tiny sphere on a large one: centre distance 1 + 1e-6 - 1e-9, depth 1e-9 up to the rounding of the stored
  // position.
  Scene tiny;
  const double z = 1.0 + 1e-6 - 1e-9;
  tiny.add(Sphere{1}, {0, 0, 0});
  tiny.add(Sphere{1e-6}, {0, 0, z});
  const auto t = tiny.contacts();
  REQUIRE(t.size() == 1);
  CHECK(std::abs(t.gap[0] + 1e-9) < 3e-16);
}

TEST_CASE("a plane touches every body at its lowest points", "[detection][narrow]") {
  const double z = 0.45;
  // the point lies in the middle of the overlap, on a sphere or a capsule at its pole
  const auto lowest = [&](auto shape, const Quat& turn, std::size_t points, double depth, double share = 0.5) {
    Scene s;
    s.add(ground, {0, 0, 0});
    s.add(shape, {3, 4, z}, turn);
    const auto c = s.contacts();
    REQUIRE(c.size() == points);
    double deepest = 0.0;
    for (std::size_t k = 0; k < points; ++k) {
      deepest = std::min(deepest, c.gap[k]);
      CHECK(c.normal[k] == Vec3(0, 0, 1));  // A is the plane
      CHECK(std::abs(c.point(k, s.world).z() - share * c.gap[k]) < 1e-15);
    }
    CHECK(deepest == Approx(-depth).epsilon(1e-12));
  };
  const Quat upright(1, 0, 0, 0), lying(Eigen::AngleAxisd(2 * std::atan(1.0), Vec3::UnitY()));
  lowest(Sphere{0.5}, upright, 1, 0.05, 1.0);
  lowest(Box(Vec3(1, 1, 0.5)), upright, 4, 0.05);
  lowest(support::unit_tetrahedron(), Quat::FromTwoVectors(Vec3(1, 1, 1), -Vec3::UnitZ()), 1, std::sqrt(0.375) - z);
  lowest(Capsule(0.5, 2), lying, 2, 0.05, 1.0);
  lowest(Cylinder(0.5, 2), lying, 2, 0.05);
  lowest(Cylinder(2, 1), upright, 4, 0.05);
  lowest(Ellipsoid(Vec3(2, 1, 0.5)), upright, 1, 0.05);
}

TEST_CASE("sphere against box and hull: outside, at an edge, inside", "[detection][narrow]") {
  const Box box(Vec3(1, 2, 3));
  const auto gap = [&](const auto& shape, const Vec3& x) {
    Scene s;
    s.add(shape, {0, 0, 0});
    s.add(Sphere{0.5}, x);
    const auto c = s.contacts(10.0);
    REQUIRE(c.size() == 1);
    CHECK(std::abs(c.normal[0].norm() - 1.0) < 1e-15);
    return c.gap[0];
  };
  for (const auto& [x, expected] : std::vector<std::pair<Vec3, double>>{
           {{1.4, 0.2, -0.3}, -0.1}, {{1.3, 2.4, 0}, 0.0}, {{2, 4, 5}, 2.5}, {{0.75, 0, 0}, -0.75}}) {
    CHECK(std::abs(gap(box, x) - expected) < 4e-16);
    CHECK(std::abs(gap(box.hull, x) - expected) < 2e-15);
  }
}

TEST_CASE("capsules: crossed, parallel, end to end", "[detection][narrow]") {
  const Quat along_x(Eigen::AngleAxisd(2 * std::atan(1.0), Vec3::UnitY()));
  const auto contacts = [&](const Vec3& x, const Quat& turn) {
    Scene s;
    s.add(Capsule(0.5, 2), {0, 0, 0});
    s.add(Capsule(0.25, 2), x, turn);
    return s.contacts(1.0);
  };
  const auto crossed = contacts({0.3, 0.7, 0.2}, along_x);
  REQUIRE(crossed.size() == 1);
  CHECK(std::abs(crossed.gap[0] + 0.05) < 1e-15);
  CHECK((crossed.arm[0] - Vec3(0, 0.475, 0.2)).norm() < 1e-15);  // between 0.5 and 0.45, on A's axis at z = 0.2
  CHECK(crossed.effective_radius[0] == Approx(0.5 / 3).epsilon(1e-14));
  const auto parallel = contacts({0.7, 0, 0.5}, Quat(1, 0, 0, 0));
  REQUIRE(parallel.size() == 2);
  CHECK(parallel.arm[0].z() == Approx(-0.5).epsilon(1e-14));  // common length from -0.5 to 1
  CHECK(parallel.arm[1].z() == Approx(1.0).epsilon(1e-14));
  const auto end = contacts({0, 0, 2.7}, Quat(1, 0, 0, 0));
  REQUIRE(end.size() == 1);
  CHECK(std::abs(end.gap[0] + 0.05) < 1e-15);
  CHECK((end.normal[0] - Vec3::UnitZ()).norm() < 1e-15);
  // The same body in the same place parts across its axis.
  const auto same = contacts({0, 0, 0}, Quat(1, 0, 0, 0));
  REQUIRE(same.size() == 2);
  CHECK(std::abs(same.gap[0] + 0.75) < 1e-15);
  CHECK(std::abs(same.normal[0].z()) < 1e-15);
}

TEST_CASE("capsules agree with GJK on their axes", "[detection][narrow]") {
  Random random(61, 0);
  for (int k = 0; k < 300; ++k) {
    const Capsule a(0.2, random.uniform(0.1, 2)), b(0.3, random.uniform(0.1, 2));
    const Pose pa{testing::random_point(random), testing::random_turn(random)},
        pb{testing::random_point(random), testing::random_turn(random)};
    ContactSet closed, general;
    ContactSink closed_sink(closed), general_sink(general);
    const PairQuery q{pa, pb, 10.0, false, nullptr};
    closed_sink.begin(0, 1);
    collide_closed(a, b, q, closed_sink);
    closed_sink.end();
    general_sink.begin(0, 1);
    collide(a, b, q, general_sink);
    general_sink.end();
    REQUIRE(closed.size() == 1);
    REQUIRE(general.size() == 1);
    CHECK(std::abs(closed.gap[0] - general.gap[0]) < 1e-12);
    CHECK((closed.arm[0] - general.arm[0]).norm() < 1e-6);  // along nearly parallel axes the point is ill-determined
  }
}

TEST_CASE("exchanging the bodies turns the normal and keeps gap and point", "[detection][narrow]") {
  for (int k = 0; k < 60; ++k) {
    Scene s = mixed(static_cast<std::uint64_t>(k), 12), t;
    t.shapes = s.shapes;
    for (Slot b = static_cast<Slot>(s.world.size()); b-- > 0;) {  // the same bodies in reversed order
      Body body;
      body.position = s.world.position[b];
      body.orientation = s.world.orientation[b];
      body.mass = 1.0;
      body.inertia = Vec3::Ones();
      body.shape = s.world.shape[b];
      t.world.add(body);
    }
    const auto cs = s.contacts(0.01), ct = t.contacts(0.01);
    const auto n = static_cast<Slot>(s.world.size());
    // Deepest contact of every pair, by the first scene's slots.
    std::map<std::pair<Slot, Slot>, double> deepest;
    for (std::size_t i = 0; i < cs.size(); ++i) {
      auto [it, fresh] = deepest.emplace(std::pair(cs.a[i], cs.b[i]), cs.gap[i]);
      it->second = std::min(it->second, cs.gap[i]);
    }
    std::map<std::pair<Slot, Slot>, double> reversed;
    for (std::size_t i = 0; i < ct.size(); ++i) {
      auto [it, fresh] = reversed.emplace(std::pair(n - 1 - ct.b[i], n - 1 - ct.a[i]), ct.gap[i]);
      it->second = std::min(it->second, ct.gap[i]);
    }
    REQUIRE(deepest.size() == reversed.size());
    for (const auto& [pair, gap] : deepest) {
      INFO("shapes " << ShapeRef{s.world.shape[pair.first]}.type() << " "
                     << ShapeRef{s.world.shape[pair.second]}.type());
      CHECK(std::abs(gap - reversed.at(pair)) < 1e-7);  // EPA of smooth bodies; polyhedra are held to 1e-12 elsewhere
    }
  }
}

TEST_CASE("contacts are canonical and the same bits at every thread count, with or without remembered directions",
          "[detection][narrow]") {
  Scene s = mixed(7, 150);
  s.pair_all();
  REQUIRE(s.pairs.pairs.size() > 4 * 1024);
  const support::KeepThreads keep;
  ContactSet reference;
  for (const int n : {1, 2, 3, 4, 7, 8}) {
    set_thread_count(n);
    BatchNarrowPhase narrow(s.shapes, 0.02, true);
    ContactSet contacts;
    narrow.collide(s.world, s.pairs, contacts);
    if (n == 1) reference = contacts;
    CHECK(same_bits(contacts, reference));
    narrow.collide(s.world, s.pairs, contacts);  // now every pair has a remembered direction
    CHECK(same_bits(contacts, reference));
  }
  REQUIRE(reference.size() > 100);
  for (std::size_t i = 1; i < reference.size(); ++i) {
    const auto key = [&](std::size_t k) { return std::tuple(reference.a[k], reference.b[k], reference.feature[k]); };
    CHECK(key(i - 1) < key(i));
  }
}

TEST_CASE("a crowd that moves has the contacts of a search from nothing, over new lists and thread counts",
          "[detection][narrow]") {
  Scene s = mixed(8, 80);
  Random random(9, 0);
  const support::KeepThreads keep;
  BatchNarrowPhase narrow(s.shapes, 0.02, true);
  s.pair_all();
  const PairColumn all = s.pairs.pairs;
  for (int step = 0; step < 12; ++step) {
    if (step % 3 == 0) {  // a list that has lost some of its pairs and found others again
      s.pairs.pairs.clear();
      ++s.pairs.generation;
      for (const Pair& p : all)
        if (random.uniform() < 0.8) s.pairs.pairs.push_back(p);
    }
    set_thread_count(1 + step % 4);
    ContactSet remembered, fresh;
    narrow.collide(s.world, s.pairs, remembered);
    BatchNarrowPhase(s.shapes, 0.02, true).collide(s.world, s.pairs, fresh);
    CHECK(same_bits(remembered, fresh));
    for (Slot b = 1; b < s.world.size(); ++b) {
      const double stride = step < 9 ? 1e-3 : 0.1;
      s.world.position[b] += stride * testing::random_direction(random);
      s.world.orientation[b] =
          Quat(Eigen::AngleAxisd(stride, testing::random_direction(random))) * s.world.orientation[b];
    }
  }
}

TEST_CASE("B10: a thousand kilometres from the origin the contacts are the same bits", "[detection][narrow][B10]") {
  // Positions on a grid of 2^-26 m are exact there too, and only differences of positions enter.
  const auto at = [](const Vec3& offset) {
    Scene s = mixed(10, 120);
    for (Vec3& x : s.world.position) {
      for (int k = 0; k < 3; ++k) x[k] = std::ldexp(std::round(std::ldexp(x[k], 26)), -26);
      x += offset;
    }
    return s.contacts(0.02);
  };
  const ContactSet here = at(Vec3::Zero()), there = at(Vec3(1e6, -1e6, 1e6));
  CHECK(here.size() > 100);
  CHECK(same_bits(here, there));
}

TEST_CASE("a world without rotation needs no orientations", "[detection][narrow]") {
  ShapeStore shapes;
  World world{Columns{}};
  Body body;
  body.mass = 1.0;
  body.shape = shapes.add(Sphere{0.5}).packed;
  for (int k = 0; k < 3; ++k) {
    body.position = Vec3(0.9 * k, 0, 0);
    world.add(body);
  }
  PairList pairs{{{0, 1}, {0, 2}, {1, 2}}, 0.0, 1};
  BatchNarrowPhase narrow(shapes, 0.0, false);
  ContactSet contacts;
  narrow.collide(world, pairs, contacts);
  REQUIRE(contacts.size() == 2);
  CHECK(contacts.effective_radius.empty());
}

TEST_CASE("capsules touch as each pair alone does, whatever the width of the loop that leaves out the others",
          "[detection][narrow]") {
  Random random(65, 1);
  for (int k = 0; k < 60; ++k) {
    const double scale = std::pow(10.0, random.uniform(-6.0, 3.0));
    Scene s;
    std::vector<Capsule> shapes;
    for (int i = 0; i < 24; ++i) {
      const Capsule c(scale * random.uniform(0.1, 0.4), i % 5 == 0 ? 0.0 : scale * random.uniform(0.0, 3.0));
      // parallel, crossing at right angles and collinear ones among them
      const Quat turn = i % 3 == 0   ? Quat(1, 0, 0, 0)
                        : i % 3 == 1 ? Quat(std::sqrt(0.5), std::sqrt(0.5), 0, 0)
                                     : testing::random_turn(random);
      Vec3 x = scale * Vec3(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
      if (i % 4 == 0) x = Vec3(0, 0, x.z());
      shapes.push_back(c);
      s.add(c, x, turn);
    }
    const double reach = k % 2 == 0 ? 0.0 : scale * random.uniform(0.0, 0.3);
    ContactSet right;
    right.with_curvature = true;
    ContactSink sink(right);
    for (Slot a = 0; a < 24; ++a)
      for (Slot b = a + 1; b < 24; ++b) {
        sink.begin(a, b);
        collide_closed(shapes[a], shapes[b], PairQuery{s.world.pose(a), s.world.pose(b), reach, true}, sink);
        sink.end();
      }
    REQUIRE(right.size() > 0);
    for (const Target most : {Target::baseline, Target::avx2, Target::avx512}) {
      limit_target(most);
      const ContactSet found = s.contacts(reach);
      limit_target(Target::avx512);
      INFO("case " << k << " scale " << scale << " reach " << reach);
      CHECK(found.a == right.a);
      CHECK(found.b == right.b);
      CHECK(found.feature == right.feature);
      CHECK(found.gap == right.gap);
      CHECK(found.normal == right.normal);
      CHECK(found.arm == right.arm);
    }
  }
}

TEST_CASE("each two balls of two clumps touch where their centres are nearer than their radii say",
          "[detection][narrow]") {
  Random random(65, 2);
  std::size_t touching = 0;
  for (int k = 0; k < 200; ++k) {
    const double scale = std::pow(10.0, random.uniform(-6.0, 3.0));
    const auto clump = [&] {
      Clump c;
      const int balls = 1 + static_cast<int>(random.uniform(0.0, 9.0));
      for (int i = 0; i < balls; ++i)
        c.parts.push_back({scale * testing::random_point(random), scale * random.uniform(0.05, 0.6)});
      return c;
    };
    Scene s;
    std::vector<Clump> shapes;
    for (int i = 0; i < 6; ++i) {
      shapes.push_back(clump());
      s.add(shapes.back(), 2.0 * scale * testing::random_point(random), testing::random_turn(random));
    }
    const double reach = k % 2 == 0 ? 0.0 : scale * random.uniform(0.0, 0.2);
    const ContactSet found = s.contacts(reach);
    std::size_t at = 0;
    for (Slot a = 0; a < 6; ++a)
      for (Slot b = a + 1; b < 6; ++b)
        for (std::size_t i = 0; i < shapes[a].parts.size(); ++i)
          for (std::size_t j = 0; j < shapes[b].parts.size(); ++j) {
            const PlacedBall &p = shapes[a].parts[i], &r = shapes[b].parts[j];
            const Vec3 x = s.world.pose(a).to_world(p.centre), y = s.world.pose(b).to_world(r.centre);
            const double gap = (y - x).norm() - (p.radius + r.radius);
            if (!(gap < reach - 1e-14 * scale)) continue;
            REQUIRE(at < found.size());
            INFO("case " << k << " bodies " << a << " " << b << " balls " << i << " " << j);
            CHECK(found.a[at] == a);
            CHECK(found.b[at] == b);
            CHECK(found.feature[at] >> 40 == (i << 8 | j));
            CHECK(std::abs(found.gap[at] - gap) <= 1e-14 * scale);
            CHECK((found.normal[at] - (y - x).normalized()).norm() < 1e-13 * scale / (y - x).norm());
            const Vec3 point = x + p.radius / (p.radius + r.radius) * (y - x) - s.world.position[a];
            CHECK((found.arm[at] - point).norm() <= 1e-14 * scale);
            ++at;
          }
    CHECK(at == found.size());
    touching += at;
  }
  CHECK(touching > 1000);
}
