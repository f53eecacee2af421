#include "engine/state/world.h"

#include <cmath>
#include <set>

#include "engine/units/random.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

/// Body k carries k in all its columns, so that a mixed-up column shows.
Body numbered(int k) {
  Body b;
  b.position = Vec3(k, 2 * k, 3 * k);
  b.velocity = Vec3(-k, 0, k);
  b.angular_velocity = Vec3(0, k, 0);
  b.mass = 1.0 + k;
  b.inertia = Vec3(1 + k, 2 + k, 3 + k);
  b.external_force = Vec3(k, k, k);
  b.shape = static_cast<std::uint32_t>(100 + k);
  b.material = static_cast<std::uint16_t>(k % 7);
  return b;
}

World numbered_world(int n, Columns columns) {
  World world(columns);
  for (int k = 0; k < n; ++k) world.add(numbered(k));
  return world;
}

/// Every column of the slot belongs to the body of its id, and slot_of finds it.
bool consistent(const World& world) {
  for (Slot s = 0; s < world.size(); ++s) {
    const auto k = static_cast<int>(world.id[s]);
    const Body b = numbered(k);
    if (world.slot_of(world.id[s]) != s || world.shape[s] != b.shape || world.material[s] != b.material) return false;
    if (world.position[s] != b.position || world.velocity[s] != b.velocity || world.inverse_mass[s] != 1.0 / b.mass)
      return false;
    if (world.columns().external_force && world.external_force[s] != b.external_force) return false;
    if (world.rotates() && world.angular_velocity[s] != b.angular_velocity) return false;
    if (world.rotates() && world.inverse_inertia_of(s) != Vec3(b.inertia.cwiseInverse())) return false;
  }
  return true;
}

/// Saves to, or loads from, a list of byte columns.
struct Tape : StateVisitor {
  std::vector<std::vector<std::byte>> columns;
  std::vector<std::string> names;
  bool loading = false;
  std::size_t next = 0;

 protected:
  std::size_t bytes_of(std::string_view name, std::size_t, std::size_t current) override {
    if (loading) return columns[next].size();
    names.emplace_back(name);
    return current;
  }
  void exchange(std::string_view, std::size_t, std::byte* data, std::size_t bytes) override {
    if (loading)
      std::copy_n(columns[next++].begin(), bytes, data);
    else
      columns.emplace_back(data, data + bytes);
  }
};

}  // namespace

TEST_CASE("columns and handles follow bodies through random sorting and removal", "[engine][world]") {
  const bool rotation = GENERATE(false, true), states = GENERATE(false, true);
  {
    World world = numbered_world(
        200, {.rotation = rotation, .anisotropy = rotation, .force = true, .external_force = true, .states = states});
    CHECK(world.states().size() == (states ? 200 : 0));
    Random random(3, 1);
    std::set<std::uint32_t> alive;
    for (std::uint32_t k = 0; k < 200; ++k) alive.insert(k);
    for (int round = 0; round < 20; ++round) {
      std::vector<Slot> order(world.size());
      for (Slot s = 0; s < order.size(); ++s) order[s] = s;
      for (std::size_t i = order.size(); i-- > 1;) std::swap(order[i], order[random.bits() % (i + 1)]);
      const std::vector<BodyId> before = world.id;
      const Reordering change = world.reorder(order);
      for (Slot s = 0; s < before.size(); ++s) CHECK(world.id[change.new_slot[s]] == before[s]);
      if (states) CHECK(std::isnan(world.states().data()[world.size()].position[3]));  // behind the last: nowhere
      std::vector<BodyId> gone;
      for (std::uint32_t k : alive)
        if (random.uniform() < 0.1) gone.push_back(static_cast<BodyId>(k));
      const std::vector<BodyId> whole = world.id;
      const Reordering removal = world.remove(gone);
      for (BodyId b : gone) alive.erase(static_cast<std::uint32_t>(b));
      CHECK(world.size() == alive.size());
      CHECK(consistent(world));
      for (BodyId b : gone) CHECK(world.slot_of(b) == no_slot);
      for (Slot s = 0, last = 0; s < whole.size(); ++s) {  // slots close up in order
        const Slot to = removal.new_slot[s];
        if (to == no_slot) continue;
        CHECK((to == last && world.id[to] == whole[s]));
        ++last;
      }
    }
    const BodyId next = world.add(numbered(200));
    CHECK(static_cast<std::uint32_t>(next) == 200);  // ids of removed bodies are not reused
    CHECK(consistent(world));
  }
}

TEST_CASE("a world pays for the columns it declares", "[engine][world]") {
  World lean({.rotation = false, .force = false});
  World full({.rotation = true, .anisotropy = true, .force = true, .external_force = true});
  lean.add(numbered(1));
  full.add(numbered(1));
  // id, shape, slot 4 each, material 2, inverse mass 8, position and velocity 24 each
  CHECK(lean.bytes_per_body() == 4 + 4 + 4 + 2 + 8 + 48);
  // + force, external force, torque, angular velocity and momentum, inverse inertia 24 each, orientation 32
  CHECK(full.bytes_per_body() == lean.bytes_per_body() + 6 * 24 + 32);
  World together({.rotation = true, .anisotropy = true, .force = true, .external_force = true, .states = true});
  together.add(numbered(1));
  CHECK(together.bytes_per_body() == full.bytes_per_body() - 3 * 24 - 8 + sizeof(BodyState));
  CHECK(together.states()[0].velocity[3] == full.inverse_mass[0]);
  World even({.rotation = true, .force = true, .external_force = true});
  Body ball = numbered(1);
  CHECK_THROWS_AS(even.add(ball), std::invalid_argument);  // its moments are unequal
  ball.inertia = Vec3::Constant(2.0);
  even.add(ball);
  CHECK(even.bytes_per_body() == full.bytes_per_body() - 24 - (24 - 8));  // no momentum, one moment
  World beads({.rotation = true, .force = true, .external_force = true, .states = true});
  beads.add(ball);
  CHECK(beads.bytes_per_body() == even.bytes_per_body() - 3 * 24 - 2 * 8 + sizeof(BodyState));
  CHECK(beads.states()[0].predicted[3] == 0.5);
  CHECK(even.inverse_inertia_of(0) == Vec3(0.5, 0.5, 0.5));
  CHECK(even.apply_inverse_inertia(0, Vec3(1, 2, 3)) == Vec3(0.5, 1, 1.5));
  CHECK(lean.orientation.empty());
  CHECK(lean.force.empty());
  CHECK(lean.pose(0).orientation.coeffs() == Quat(1, 0, 0, 0).coeffs());
}

TEST_CASE("acceleration is gravity and forces over mass; fixed bodies have none", "[engine][world]") {
  World world({.rotation = false, .force = true, .external_force = true});
  world.gravity = Vec3(0, 0, -10);
  Body b = numbered(3);  // mass 4, external force (3, 3, 3)
  world.add(b);
  b.mass = 0.0;
  world.add(b);
  world.force[0] = world.force[1] = Vec3(8, 0, 0);
  CHECK(world.acceleration(0) == Vec3(2.75, 0.75, -9.25));
  CHECK(world.acceleration(1) == Vec3(0, 0, 0));
  CHECK((world.is_movable(0) && !world.is_movable(1)));
}

TEST_CASE("I^-1 x is that of the turned body", "[engine][world]") {
  World world({.rotation = true, .anisotropy = true});
  Body b = numbered(0);
  b.inertia = Vec3(1, 2, 4);
  b.orientation = Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix());
  world.add(b);
  const Mat3 r = b.orientation.toRotationMatrix();
  const Mat3 inertia = r * Vec3(1, 2, 4).asDiagonal() * r.transpose();
  const Vec3 x(0.3, -2, 1.1);
  CHECK((inertia * world.apply_inverse_inertia(0, x) - x).norm() < 1e-14);
}

TEST_CASE("Morton order is that of interleaved cell indices, ties by id", "[engine][world]") {
  World world;
  Random random(1, 1);
  for (int k = 0; k < 300; ++k) {
    Body b = numbered(k);
    b.position = Vec3(random.uniform(-3, 5), random.uniform(2, 4), random.uniform(0, 1));
    if (k % 10 == 9) b.position = world.position[static_cast<std::size_t>(k - 1)];
    world.add(b);
  }
  const auto order = morton_order(world);
  Vec3 low = world.position[0], high = low;
  for (const Vec3& x : world.position) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double extent = (high - low).maxCoeff();
  const auto code = [&](Slot s) {  // bit by bit, from the definition
    unsigned long long c = 0;
    for (int bit = 0; bit < 10; ++bit)
      for (int d = 0; d < 3; ++d) {
        const auto cell = static_cast<unsigned long long>((world.position[s][d] - low[d]) * (1023.0 / extent));
        c |= (cell >> bit & 1ULL) << (3 * bit + d);
      }
    return c;
  };
  CHECK(std::set<Slot>(order.begin(), order.end()).size() == 300);
  for (std::size_t k = 1; k < order.size(); ++k) {
    const auto before = code(order[k - 1]), after = code(order[k]);
    CHECK((before < after || (before == after && world.id[order[k - 1]] < world.id[order[k]])));
  }
  CHECK(morton_order(World()).empty());
}

TEST_CASE("Morton neighbours are near: sorting shortens the walk along the slots", "[engine][world]") {
  World world;
  Random random(8, 1);
  for (int k = 0; k < 4096; ++k) {
    Body b = numbered(k);
    b.position = Vec3(random.uniform(), random.uniform(), random.uniform());
    world.add(b);
  }
  const auto walk = [&] {
    double length = 0.0;
    for (Slot s = 1; s < world.size(); ++s) length += (world.position[s] - world.position[s - 1]).norm();
    return length / 4095;
  };
  CHECK(walk() == Approx(0.6617).epsilon(0.03));  // mean distance of two random points in the unit cube (Robbins 1978)
  world.reorder(morton_order(world));
  CHECK(walk() < 2.0 / 16);  // 4096 = 16^3: two spacings
}

TEST_CASE("the state hash does not depend on slots, and sees the last bit", "[engine][world][hash]") {
  World world = numbered_world(50, {.rotation = true, .anisotropy = true});
  World other = numbered_world(50, {.rotation = true, .anisotropy = true});
  const std::string hash = state_hash(world);
  CHECK(hash.size() == 16);
  world.reorder(morton_order(world));
  std::vector<Slot> reversed(50);
  for (Slot s = 0; s < 50; ++s) reversed[s] = 49 - s;
  world.reorder(reversed);
  CHECK(state_hash(world) == hash);
  const auto changes = [&](double& value) {
    const double kept = value;
    value = std::nextafter(value, 1e9);
    const bool different = state_hash(other) != hash;
    value = kept;
    return different;
  };
  CHECK(changes(other.position[7].y()));
  CHECK(changes(other.velocity[7].x()));
  CHECK(changes(other.orientation[7].w()));
  CHECK(changes(other.angular_velocity[49].z()));
  CHECK(state_hash(other) == hash);
  other.remove(std::vector<BodyId>{static_cast<BodyId>(3)});
  CHECK(state_hash(other) != hash);
}

TEST_CASE("one walk saves, loads and counts the whole state, wherever position, velocity and spin lie",
          "[engine][world]") {
  const bool from_states = GENERATE(false, true), to_states = GENERATE(false, true);
  World world = numbered_world(
      40, {.rotation = true, .anisotropy = true, .force = true, .external_force = true, .states = from_states});
  world.time = 1.25;
  world.remove(std::vector<BodyId>{static_cast<BodyId>(5), static_cast<BodyId>(11)});
  Tape tape;
  world.visit(tape);
  CHECK(std::set<std::string>(tape.names.begin(), tape.names.end()).size() == tape.names.size());
  World copy({.rotation = true, .anisotropy = true, .force = true, .external_force = true, .states = to_states});
  tape.loading = true;
  copy.visit(tape);
  CHECK(copy.time == 1.25);
  CHECK(copy.size() == 38);
  CHECK(consistent(copy));
  CHECK(state_hash(copy) == state_hash(world));
  CHECK(copy.slot_of(static_cast<BodyId>(11)) == no_slot);
  ByteCounter bytes;
  world.visit(bytes);
  std::size_t saved = 0;
  for (const auto& c : tape.columns) saved += c.size();
  CHECK(bytes.total == saved);
}

TEST_CASE("position, velocity and spin lie in the body's state, and room for more bodies leaves them there",
          "[engine][world]") {
  World world({.rotation = true, .anisotropy = true, .states = true});
  world.reserve(30);
  for (int k = 0; k < 3; ++k) world.add(numbered(k));
  const BodyState* const first = world.states().data();
  for (int k = 3; k < 30; ++k) world.add(numbered(k));
  CHECK(world.states().data() == first);
  CHECK(consistent(world));
  const BodyState& state = world.states()[7];
  for (int k = 0; k < 3; ++k) {
    CHECK(state.position[k] == world.position[7][k]);
    CHECK(state.velocity[k] == world.velocity[7][k]);
    CHECK(state.spin[k] == world.angular_velocity[7][k]);
  }
  world.states()[8].velocity[1] = 2.5;
  CHECK(world.velocity[8].y() == 2.5);
  const StateColumn<Vec3> alone = world.position;  // a copy is a column of its own
  world.position[0].x() = 9.0;
  CHECK(alone[0].x() == 0.0);
  CHECK(alone.stride() == sizeof(Vec3));
  world.position = alone;
  CHECK(world.states()[0].position[0] == 0.0);
  std::size_t seen = 0;
  for (const Vec3& x : world.position) seen += x == alone[seen] ? 1 : 0;
  CHECK(seen == 30);
}

TEST_CASE("states before those of the bodies leave bodies as they are, also when these come, leave and are sorted",
          "[engine][world]") {
  World world({.rotation = true, .anisotropy = true, .states = true}), alone = World(world.columns());
  const auto same = [&] {
    CHECK(consistent(world));
    CHECK(state_hash(world) == state_hash(alone));
    CHECK(world.states().size() == world.size());
    CHECK(&world.position[0] == reinterpret_cast<const Vec3*>(&world.states()[0].position));
    CHECK(std::isnan(world.states().data()[world.size()].position[3]));  // behind the last: nowhere
  };
  const auto both = [&](const auto& change) {
    change(world);
    change(alone);
  };
  for (int k = 0; k < 20; ++k) both([&](World& w) { w.add(numbered(k)); });
  for (const std::size_t before : {7, 0, 30, 11}) {
    world.set_states_before(before);
    CHECK(world.states_before() == before);
    same();
    for (std::size_t k = 0; k < before; ++k) (world.states().data() - before + k)->position = lanes(1e3);
    both([&](World& w) { w.add(numbered(static_cast<int>(w.ids_given()))); });
    same();
    both([&](World& w) { w.remove(std::vector<BodyId>{w.id[3]}); });
    both([](World& w) { w.reorder(morton_order(w)); });
    same();
    if (before > 0) CHECK((world.states().data() - 1)->position[0] == 1e3);
  }
}
