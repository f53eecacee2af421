// Bodies of convex parts: what bounding spheres, directions and memory leave out would not have touched, to the last
// bit.
#include "detection/narrow/pairs/part_pairs.h"

#include "detection/narrow/pairs/convex_pairs.h"
#include "detection/shapes/box.h"
#include "detection/shapes/mesh_file.h"
#include "detection/shapes/solid_parts.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

const std::string stones = std::string(EPAFI_SOURCE_DIR) + "/scenes/library/tutorials/stones/";

SolidParts stone(const std::string& file) { return place_solid(read_mesh_file(stones + file).surface).solid; }

/// Of one pair of bodies, by f(sink).
template <class F>
ContactSet contacts(bool area, const F& f) {
  ContactSet set;
  set.with_area = area;
  ContactSink sink(set);
  sink.begin(0, 1);
  f(sink);
  sink.end();
  return set;
}

template <class A, class B>
ContactSet by_part_pairs(const A& a, const B& b, const PairQuery& q) {
  return contacts(q.area, [&](ContactSink& sink) {
    each_part_pair(a, b, q, sink, [&](const auto& x, const auto& y, const PairQuery& p) { collide(x, y, p, sink); });
  });
}

/// f(part, its pose) within the sink's part; a body without parts is one part.
template <class W, class F>
void each_part(const W& whole, const Pose& pose, ContactSink& sink, bool is_a, const F& f) {
  if constexpr (Compound<W>) {
    for (std::size_t k = 0; k < whole.part_count(); ++k) {
      const Pose at = whole.part_pose(k, pose);
      const Vec3 offset = is_a ? Vec3(at.position - pose.position) : Vec3(Vec3::Zero());
      sink.enter_part(k, offset);
      f(whole.part(k), at);
      sink.leave_part(offset);
    }
  } else {
    f(whole, pose);
  }
}

/// Every part of A with every part of B, each by a search from nothing.
template <class A, class B>
ContactSet by_all(const A& a, const B& b, const PairQuery& q) {
  return contacts(q.area, [&](ContactSink& sink) {
    each_part(a, q.a, sink, true, [&](const auto& x, const Pose& at) {
      each_part(b, q.b, sink, false, [&](const auto& y, const Pose& there) {
        collide(x, y, {at, there, q.reach, q.curvature, nullptr, q.area}, sink);
      });
    });
  });
}

bool same(const ContactSet& x, const ContactSet& y) {
  return x.feature == y.feature && x.gap == y.gap && x.normal == y.normal && x.arm == y.arm && x.area == y.area;
}

Vec3 random_vector(Random& random, double size) {
  return size * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
}

/// B wanders near A: small steps, in which memory serves, and now and then a leap, after which it must not.
template <class A, class B>
std::size_t wander(const A& a, const B& b, double reach, bool area, std::uint64_t seed) {
  Random random(seed, 0);
  const double size = std::min(a.bounding_radius(), b.bounding_radius());
  PartMemory memory;
  PairCache cache;
  PairQuery q{
      {Vec3(3, -2, 7), Quat(0.5, 0.1, -0.7, 0.5).normalized()}, {}, reach, false, &cache, area, nullptr, &memory};
  std::size_t touching = 0, differ = 0;
  for (int step = 0; step < 600; ++step) {
    const bool leap = step % 40 == 0;
    if (leap) {
      const Vec3 d = random_vector(random, 1.0).normalized();
      q.b = {q.a.position + random.uniform(0.5, 1.0) * (a.bounding_radius() + b.bounding_radius()) * d,
             Quat(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1))
                 .normalized()};
    }
    q.b.position += random_vector(random, 0.01 * size) + 0.005 * (q.a.position - q.b.position);
    const Vec3 turn = random_vector(random, 0.02);
    q.b.orientation = (Quat(1, turn.x(), turn.y(), turn.z()).normalized() * q.b.orientation).normalized();
    const ContactSet found = by_part_pairs(a, b, q), all = by_all(a, b, q);
    touching += all.size() > 0;
    differ += !same(found, all);
  }
  CHECK(differ == 0);
  return touching;
}

}  // namespace

TEST_CASE("parts that are asked give what all parts would, whatever they remember", "[detection][parts][long]") {
  const SolidParts a = stone("stone_a.obj"), b = stone("stone_b.stl");
  const double size = a.bounding_radius();
  const Box floor(size * Vec3(3, 2, 0.5));
  const bool area = GENERATE(false, true);
  const double reach = area ? 0.0 : 0.02 * size;
  CHECK(wander(a, b, reach, area, 1) > 200);
  CHECK(wander(b, floor, reach, area, 2) > 100);
  CHECK(wander(floor, a, reach, area, 3) > 100);
}

TEST_CASE("what parts remember stays with the parts that are asked", "[detection][parts]") {
  PartMemory memory;
  for (std::uint32_t first = 0; first < 1000; first += 10) {
    memory.begin();
    for (std::uint32_t k = 0; k < 10; ++k) memory.of(first + k).axis = Vec3(1, first + k, 0);
    memory.end();
    memory.begin();
    for (std::uint32_t k = 0; k < 10; ++k) {
      const Vec3 axis = memory.of(first + k).axis;
      CHECK((axis.isZero(0.0) || axis.y() == first + k));  // its own, or forgotten
    }
    memory.end();
    CHECK(memory.size() <= 28);  // twice those asked and 8
  }
}
