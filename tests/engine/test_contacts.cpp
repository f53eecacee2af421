#include "engine/state/contacts.h"

#include <map>
#include <tuple>

#include "engine/threads/parallel.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"

using namespace epafi;

namespace {

using Key = std::tuple<Slot, Slot, Feature>;

ContactSet set_of(const std::vector<Key>& keys) {
  ContactSet set;
  for (const auto& [a, b, feature] : keys) {
    ContactPoint c;
    c.feature = feature;
    set.append(a, b, c);
  }
  return set;
}

/// Fixed bodies in a row, 1 m apart.
World row_of(Slot bodies) {
  World world;
  Body body;
  for (Slot s = 0; s < bodies; ++s) {
    body.position = Vec3(s, 0, 0);
    world.add(body);
  }
  return world;
}
const World row = row_of(120);

/// A random subset of pairs near each other, one to three features, in canonical order.
std::vector<Key> random_keys(Random& random, Slot bodies, double share) {
  std::vector<Key> keys;
  for (Slot a = 0; a < bodies; ++a)
    for (Slot b = 0; b < bodies; ++b)  // b < a happens: slot order is not id order
      for (std::uint32_t f = 0; f < 3; ++f)
        if (a != b && (a + b) % 5 != 0 && random.uniform() < share) keys.emplace_back(a, b, feature_of(f, 7 * f));
  return keys;
}

}  // namespace

TEST_CASE("contact memory finds what a map finds, through random churn", "[engine][contacts]") {
  Random random(5, 1);
  ContactMemory memory;
  std::map<Key, std::uint32_t> remembered;
  for (int step = 0; step < 60; ++step) {
    // now and then all contacts are lost, and blocks are longer than one (4096)
    const double share = step % 13 == 0 ? 0.0 : step % 17 == 0 ? 0.9 : 0.3;
    const auto keys = random_keys(random, 60, share);
    std::vector<std::uint32_t> previous;
    memory.match(row, set_of(keys), previous);
    REQUIRE(previous.size() == keys.size());
    bool same = true;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const auto found = remembered.find(keys[i]);
      same = same && previous[i] == (found == remembered.end() ? ContactMemory::none : found->second);
    }
    REQUIRE(same);
    remembered.clear();
    for (std::uint32_t i = 0; i < keys.size(); ++i) remembered[keys[i]] = i;
    CHECK(memory.size() == keys.size());
  }
}

TEST_CASE("contact memory follows renamed and removed bodies", "[engine][contacts]") {
  Random random(6, 1);
  for (int round = 0; round < 20; ++round) {
    const Slot bodies = 40;
    const auto keys = random_keys(random, bodies, 0.2);
    ContactMemory memory;
    std::vector<std::uint32_t> previous;
    memory.match(row, set_of(keys), previous);
    std::vector<Slot> order;
    for (Slot s = 0; s < bodies; ++s)
      if (random.uniform() < 0.8) order.push_back(s);
    for (std::size_t i = order.size(); i-- > 1;) std::swap(order[i], order[random.bits() % (i + 1)]);
    Reordering change{std::vector<Slot>(bodies, no_slot)};
    for (Slot k = 0; k < order.size(); ++k) change.new_slot[order[k]] = k;

    std::map<Key, std::uint32_t> expected;  // new key -> old index, in canonical order
    for (std::uint32_t i = 0; i < keys.size(); ++i) {
      const auto& [a, b, f] = keys[i];
      if (change.new_slot[a] != no_slot && change.new_slot[b] != no_slot)
        expected[{change.new_slot[a], change.new_slot[b], f}] = i;
    }
    const auto kept = memory.reorder(change);
    REQUIRE(kept.size() == expected.size());
    std::vector<Key> renamed;
    std::size_t i = 0;
    bool same = true;
    for (const auto& [key, old] : expected) {
      same = same && kept[i++] == old;
      renamed.push_back(key);
    }
    CHECK(same);
    memory.match(row, set_of(renamed), previous);  // all are found where reorder put them
    for (std::uint32_t k = 0; k < previous.size(); ++k) same = same && previous[k] == k;
    CHECK(same);
  }
}

TEST_CASE("contact memory is the same for every thread count", "[engine][contacts][threads]") {
  const support::KeepThreads keep;
  Random random(7, 1);
  const auto first = random_keys(random, 120, 0.5), second = random_keys(random, 120, 0.5);
  std::vector<std::uint32_t> reference;
  for (int threads : {1, 2, 3, 4, 7, 8}) {
    set_thread_count(threads);
    ContactMemory memory;
    std::vector<std::uint32_t> previous;
    memory.match(row, set_of(first), previous);
    memory.match(row, set_of(second), previous);
    if (threads == 1) reference = previous;
    CHECK(previous == reference);
  }
}

TEST_CASE("features of different words differ and keep their order", "[engine][contacts]") {
  CHECK(feature_of(1, 0) > feature_of(0, 0xffffffffu));
  CHECK(feature_of(2, 3) != feature_of(3, 2));
  CHECK(feature_of(0xffffffffu, 0xffffffffu) == ~Feature{0});
}

TEST_CASE("arms of A and B meet in the contact point; joined sets keep their columns in step", "[engine][contacts]") {
  World world;
  Body body;
  body.position = Vec3(1, 2, 3);
  body.mass = 1;
  world.add(body);
  body.position = Vec3(4, 2, 3);
  world.add(body);
  ContactSet set, other;
  set.with_curvature = other.with_curvature = true;
  ContactPoint c;
  c.arm = Vec3(1.5, 0.25, 0);
  c.gap = -0.1;
  c.effective_radius = 0.7;
  set.append(0, 1, c);
  c.gap = -0.2;
  other.append(1, 0, c);
  set.append(other);
  CHECK(set.point(0, world) == Vec3(2.5, 2.25, 3));
  CHECK(world.position[1] + set.arm_b(0, world) == set.point(0, world));
  CHECK(set.size() == 2);
  CHECK(set.gap[1] == -0.2);
  CHECK(set.effective_radius.size() == 2);
  set.clear();
  CHECK((set.size() == 0 && set.effective_radius.empty() && set.with_curvature));
}

TEST_CASE("on a mesh a contact goes on over an edge, where it can be told which", "[engine][contacts]") {
  const auto previous_of = [](const std::vector<Feature>& before, const std::vector<Feature>& now, bool mesh) {
    const auto keys = [](const std::vector<Feature>& features) {
      std::vector<Key> all = {{1, 8, 5}};
      for (const Feature f : features) all.emplace_back(3, 9, f);
      return all;
    };
    ContactMemory memory;
    std::vector<std::uint32_t> previous;
    memory.match(row, set_of(keys(before)), previous);
    ContactSet set = set_of(keys(now));
    if (mesh) set.meshes = {4, 9};
    memory.match(row, set, previous);
    previous.erase(previous.begin());
    return previous;
  };
  const auto side = [](Feature face, Feature on_body) { return face << 28 | on_body; };
  using List = std::vector<std::uint32_t>;
  constexpr std::uint32_t none = ContactMemory::none;
  CHECK(previous_of({side(2, 0)}, {side(7, 0)}, true) == List{1});
  CHECK(previous_of({side(2, 0)}, {side(7, 0)}, false) == List{none});
  CHECK(previous_of({side(2, 0)}, {side(2, 3)}, true) == List{1});                    // from the face to its edge
  CHECK(previous_of({side(2, 0)}, {side(2, 0), side(7, 0)}, true) == List{1, none});  // the face goes on
  CHECK(previous_of({side(2, 5), side(2, 6)}, {side(7, 5), side(7, 6)}, true) == List{1, 2});  // two corners of a box
  CHECK(previous_of({side(2, 5), side(3, 5)}, {side(7, 5), side(8, 5)}, true) == List{none, none});
  CHECK(previous_of({side(2, 0) | Feature{1} << 56}, {side(7, 0)}, true) == List{none});  // of another image
  CHECK(previous_of({}, {side(7, 0)}, true) == List{none});

  ContactMemory memory;  // the next face was near before its contact took over
  List previous;
  ContactSet set = set_of({{3, 9, side(2, 0)}, {3, 9, side(7, 0)}});
  set.meshes = {9};
  memory.match(row, set, previous);
  ContactSet later = set_of({{3, 9, side(7, 0)}});
  later.meshes = {9};
  const auto is_second = [](std::size_t k) { return k == 1; };
  memory.match(row, later, previous, is_second);
  CHECK(previous == List{0});
}

TEST_CASE("over joined walls a contact goes on with one that ends there, each with one", "[engine][contacts]") {
  using List = std::vector<std::uint32_t>;
  constexpr std::uint32_t none = ContactMemory::none;
  // body 5 is B of walls 3 and 4, A of wall 8
  const auto previous_of = [](const std::vector<Key>& before, const std::vector<Key>& now, bool joined, List& turned) {
    ContactMemory memory;
    List previous;
    memory.match(row, set_of(before), previous);
    ContactSet set = set_of(now);
    if (joined) set.joined = {{5, 3, 4}, {5, 3, 8}, {5, 4, 3}, {5, 8, 3}};
    turned.clear();
    memory.match(row, set, previous, {}, &turned);
    return previous;
  };
  List turned;
  CHECK(previous_of({{3, 5, 7}}, {{4, 5, 9}}, true, turned) == List{0});
  CHECK(turned.empty());
  CHECK(previous_of({{3, 5, 7}}, {{4, 5, 9}}, false, turned) == List{none});
  CHECK(previous_of({{3, 5, 7}}, {{5, 8, 7}}, true, turned) == List{0});
  CHECK(turned == List{0});
  CHECK(previous_of({{3, 5, 7}}, {{3, 5, 7}, {4, 5, 7}}, true, turned) == List{0, none});             // it goes on
  CHECK(previous_of({{3, 5, 1}, {3, 5, 2}}, {{4, 5, 2}, {4, 5, 6}}, true, turned) == List{1, none});  // by name
  CHECK(previous_of({{3, 6, 1}}, {{4, 5, 2}}, true, turned) == List{none});                           // another body's
  CHECK(previous_of({{4, 5, 1}}, {{5, 8, 2}}, true, turned) == List{none});  // walls 4 and 8 do not touch

  Random random(8, 1);
  for (int draw = 0; draw < 100; ++draw) {
    const auto before = random_keys(random, 12, 0.3), now = random_keys(random, 12, 0.3);
    ContactMemory memory;
    List previous;
    memory.match(row, set_of(before), previous);
    ContactSet set = set_of(now);
    for (Slot body = 0; body < 12; ++body)
      for (Slot wall = 0; wall < 12; ++wall)
        for (Slot other = 0; other < 12; ++other)
          if (random.uniform() < 0.2) set.joined.push_back({body, wall, other});
    memory.match(row, set, previous);
    std::vector<int> times(before.size(), 0);
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (previous[i] == none) continue;
      ++times[previous[i]];
      const bool ended = !std::binary_search(now.begin(), now.end(), before[previous[i]]);
      CHECK((ended || before[previous[i]] == now[i]));
    }
    CHECK(std::all_of(times.begin(), times.end(), [](int n) { return n <= 1; }));
  }
}

TEST_CASE("a contact that gets another name at the same place goes on, each with one", "[engine][contacts]") {
  constexpr std::uint32_t none = ContactMemory::none;
  Random random(9, 1);
  int went_on = 0;
  for (int draw = 0; draw < 200; ++draw) {
    // points of two bodies, at least 0.1 m from each other: some keep their names, some get new ones, some go
    std::vector<Vec3> points;
    while (points.size() < 6) {
      const Vec3 p(random.uniform(), random.uniform(), random.uniform());
      const auto is_near = [&](const Vec3& q) { return (p - q).norm() < 0.1; };
      if (std::none_of(points.begin(), points.end(), is_near)) points.push_back(p + Vec3(1, 1, 1));
    }
    ContactSet before, now;
    std::vector<std::pair<Feature, std::uint32_t>> expected;  // name now, index before
    for (std::uint32_t k = 0; k < points.size(); ++k) {
      ContactPoint c;
      c.feature = k;
      c.arm = points[k];
      before.append(0, 1, c);
      const double fate = random.uniform();
      if (fate < 0.3) continue;
      const bool same_place = random.uniform() < 0.7;
      c.feature = fate < 0.6 ? Feature{k} : Feature{100} + random.bits() % 1000 * 10 + k;
      const Vec3 way(random.uniform(), random.uniform(), random.uniform());
      c.arm += same_place ? Vec3(0.004 * way) : Vec3(Vec3::Constant(0.02) + 0.02 * way);
      now.append(0, 1, c);
      expected.emplace_back(c.feature, c.feature == k || same_place ? k : none);
      went_on += c.feature != k && same_place;
    }
    now.sort();
    std::sort(expected.begin(), expected.end());
    ContactMemory memory;
    std::vector<std::uint32_t> previous;
    memory.match(row, before, previous);
    memory.match(row, now, previous);
    REQUIRE(previous.size() == expected.size());
    for (std::size_t i = 0; i < previous.size(); ++i) CHECK(previous[i] == expected[i].second);
  }
  CHECK(went_on > 100);
}
