#include "engine/state/world.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "engine/lanes/prefetch.h"
#include "engine/state/hash.h"
#include "engine/state/rotation.h"
#include "engine/threads/parallel_order.h"
#include "engine/units/error.h"

namespace epafi {

namespace {
template <class T>
std::size_t bytes_of_one(const std::vector<T>&) {
  return sizeof(T);
}
template <class T>
std::size_t bytes_of_one(const StateColumn<T>& column) {
  return column.in_records() ? 0 : sizeof(T);
}
}  // namespace

template <class F>
void World::each_column(F&& f) {
  f("world/id", id);
  f("world/shape", shape);
  f("world/material", material);
  f("world/inverse_mass", inverse_mass);
  f("world/position", position);
  f("world/velocity", velocity);
  if (columns_.force) f("world/force", force);
  if (columns_.external_force) f("world/external_force", external_force);
  if (columns_.external_torque) f("world/external_torque", external_torque);
  if (columns_.loose_force) f("world/loose_force", loose_force);
  if (columns_.periodic) f("world/wraps", wraps);
  if (!columns_.rotation) return;
  if (columns_.orientation) f("world/orientation", orientation);
  f("world/angular_velocity", angular_velocity);
  if (columns_.force) f("world/torque", torque);
  if (columns_.anisotropy) {
    f("world/inverse_inertia", inverse_inertia);
    f("world/angular_momentum", angular_momentum);
  } else
    f("world/inverse_moment", inverse_moment);
}

/// Flattened: Eigen's products stay calls otherwise, twice a step and body.
[[gnu::flatten]] Vec3 World::apply_inverse_inertia_at(Slot s, const Vec3& x) const {
  const Vec3& i = inverse_inertia[s];
  const Mat3 r = orientation[s].toRotationMatrix();
  return r * i.cwiseProduct(r.transpose() * x);
}

void World::apply_angular_impulse_at(Slot s, const Vec3& impulse) {
  angular_momentum[s] += impulse;
  angular_velocity[s] = apply_inverse_inertia(s, angular_momentum[s]);
}

void World::set_angular_velocity(Slot s, const Vec3& w) {
  angular_velocity[s] = w;
  if (!columns_.anisotropy || !is_movable(s)) return;
  const Mat3 r = orientation[s].toRotationMatrix();
  angular_momentum[s] = r * (r.transpose() * w).cwiseQuotient(inverse_inertia[s]);
}

void World::rotate_at(Slot s, double dt) {
  rotate_freely(orientation[s], angular_momentum[s], inverse_inertia[s], dt);
  angular_velocity[s] = apply_inverse_inertia(s, angular_momentum[s]);
}

BodyId World::reserve() {
  slot_of_.push_back(no_slot);
  return static_cast<BodyId>(slot_of_.size() - 1);
}

void World::add(const Body& body, BodyId new_id) {
  EPAFI_REQUIRE(slot_of(new_id) == no_slot, "a body comes once");
  const bool free = body.mass > 0.0, even = (body.inertia.array() == body.inertia.x()).all();
  if (free && !even && columns_.rotation && !columns_.anisotropy)
    throw std::invalid_argument("World::add: a body with unequal principal moments needs columns().anisotropy");
  slot_of_[static_cast<std::uint32_t>(new_id)] = static_cast<Slot>(size());
  const auto s = static_cast<Slot>(size());
  resize_states(s + 1);
  each_column([&](const char*, auto& column) { column.resize(s + 1); });
  id.back() = new_id;
  shape.back() = body.shape;
  material.back() = body.material;
  inverse_mass[s] = free ? 1.0 / body.mass : 0.0;
  position[s] = body.position;
  velocity[s] = body.velocity;
  if (columns_.force) force.back().setZero();
  if (columns_.external_force) external_force.back() = body.external_force;
  if (columns_.external_torque) external_torque.back().setZero();
  if (columns_.loose_force) loose_force.back().setZero();
  if (columns_.periodic) wraps.back().setZero();
  if (columns_.rotation) {
    if (columns_.orientation) orientation.back() = body.orientation.normalized();
    if (columns_.force) torque.back().setZero();
    const Vec3 inverse = free ? Vec3(body.inertia.cwiseInverse()) : Vec3(0, 0, 0);
    if (columns_.anisotropy) {
      inverse_inertia.back() = inverse;
      angular_momentum.back().setZero();
    } else
      inverse_moment[s] = inverse.x();
    set_angular_velocity(s, body.angular_velocity);
  }
}

Reordering World::reorder(std::span<const Slot> order) {
  Reordering result{std::vector<Slot>(size(), no_slot)};
  const std::size_t n = order.size();
  each_column([&](const char*, auto& column) {
    using T = std::remove_reference_t<decltype(column[0])>;
    LargeColumn<T> sorted(n);
    parallel_for(
        n, [&](std::size_t k) { sorted[k] = column[order[k]]; }, fill_grain<LargeColumn<T>>);
    column.resize(n);  // in place: arrays over the column remain valid
    parallel_for(
        n, [&](std::size_t k) { column[k] = sorted[k]; }, fill_grain<LargeColumn<T>>);
  });
  resize_states(n);
  parallel_for(n, [&](std::size_t k) { result.new_slot[order[k]] = static_cast<Slot>(k); });
  parallel_for(slot_of_.size(), [&](std::size_t b) {
    if (slot_of_[b] != no_slot) slot_of_[b] = result.new_slot[slot_of_[b]];
  });
  return result;
}

Reordering World::remove(std::span<const BodyId> bodies) {
  std::vector<char> gone(size(), 0);
  for (BodyId b : bodies) {
    EPAFI_REQUIRE(slot_of(b) != no_slot, "a body is removed once");
    gone[slot_of(b)] = 1;
  }
  std::vector<Slot> keep;
  parallel_select(
      size(), [&](std::size_t s) { return !gone[s]; }, [](std::size_t s) { return static_cast<Slot>(s); }, keep);
  return reorder(keep);
}

void World::visit(StateVisitor& visitor) {
  visitor.value("world/time", time);
  if (visitor.has("world/clock")) {
    visitor.value("world/clock", clock);
    visitor.value("world/fallen", fallen);
  } else {  // of a run before there were stages
    clock = time;
    fallen = time * gravity;
  }
  visitor.rows(RowsOf::ids, "world/slot_of", slot_of_);
  if (cell) visitor.value("world/cell", *cell);
  each_column([&](const char* name, auto& column) {
    resize_states(size());  // id came first
    visitor.rows(RowsOf::bodies, name, column);
  });
}

void World::copy_shown(const World& from) {
  columns_ = from.columns_;
  columns_.states = columns_.force = columns_.held_force = false;
  columns_.external_force = columns_.external_torque = columns_.loose_force = false;
  time = from.time;
  clock = from.clock;
  cell = from.cell;
  slot_of_ = from.slot_of_;
  id = from.id;
  shape = from.shape;
  material = from.material;
  inverse_mass = from.inverse_mass;
  position = from.position;
  velocity = from.velocity;
  wraps = from.wraps;
  orientation = from.orientation;
  angular_velocity = from.angular_velocity;
  inverse_inertia = from.inverse_inertia;
  inverse_moment = from.inverse_moment;
}

void World::reserve(std::size_t bodies) {
  slot_of_.reserve(bodies);
  if (columns_.states) {
    states_.reserve(states_before_ + bodies + 1);
    place_states();
  }
  each_column([&](const char*, auto& column) { column.reserve(bodies); });
}

void World::resize_states(std::size_t n) {
  if (!columns_.states || states_.size() == states_before_ + n + 1) return;
  if (!states_.empty()) states_.back() = BodyState{};
  states_.resize(states_before_ + n + 1, BodyState{});
  states_.back().position = lanes(std::numeric_limits<double>::quiet_NaN());
  place_states();
}

void World::set_states_before(std::size_t count) {
  if (count == states_before_) return;
  EPAFI_REQUIRE(columns_.states && !states_.empty(), "bodies have states");
  const std::span<BodyState> bodies(states_.data() + states_before_, state_count() + 1);
  UnwrittenColumn<BodyState> all(count + bodies.size(), BodyState{});
  std::ranges::copy(bodies, all.begin() + static_cast<std::ptrdiff_t>(count));
  states_.swap(all);
  states_before_ = static_cast<std::uint32_t>(count);
  place_states();
}

void World::place_states() {
  if (!columns_.states) return;
  const auto join = [this](auto& column, Lanes BodyState::*part, std::size_t at) {
    void* const first = states_.empty() ? nullptr : reinterpret_cast<double*>(&(states_[states_before_].*part)) + at;
    column.join(first, sizeof(BodyState), state_count());
  };
  join(position, &BodyState::position, 0);
  join(velocity, &BodyState::velocity, 0);
  join(inverse_mass, &BodyState::velocity, 3);
  if (!columns_.rotation) return;
  join(angular_velocity, &BodyState::spin, 0);
  if (!columns_.anisotropy) join(inverse_moment, &BodyState::predicted, 3);
}

std::size_t World::bytes_per_body() const {
  std::size_t bytes = sizeof(Slot) + (columns_.states ? sizeof(BodyState) : 0);  // slot_of
  const_cast<World*>(this)->each_column([&](const char*, auto& column) { bytes += bytes_of_one(column); });
  return bytes;
}

namespace {
/// Spreads the lowest 21 bits of v to every third bit.
std::uint64_t spread(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffULL;
  v = (v | v << 16) & 0x1f0000ff0000ffULL;
  v = (v | v << 8) & 0x100f00f00f00f00fULL;
  v = (v | v << 4) & 0x10c30c30c30c30c3ULL;
  return (v | v << 2) & 0x1249249249249249ULL;
}
}  // namespace

std::vector<Slot> morton_order(const World& world) {
  std::vector<Slot> order(world.size());
  std::iota(order.begin(), order.end(), Slot{0});
  if (world.size() < 2) return order;
  Vec3 low = world.position[0], high = low;
  for (const Vec3& x : world.position) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double extent = std::max((high - low).maxCoeff(), 1e-300);
  std::vector<std::uint64_t> code(world.size());
  for (std::size_t s = 0; s < code.size(); ++s) {
    const Vec3 u = (world.position[s] - low) * (1023.0 / extent);
    code[s] = spread(static_cast<std::uint64_t>(u.x())) | spread(static_cast<std::uint64_t>(u.y())) << 1 |
              spread(static_cast<std::uint64_t>(u.z())) << 2;
  }
  std::sort(order.begin(), order.end(),
            [&](Slot p, Slot q) { return code[p] != code[q] ? code[p] < code[q] : world.id[p] < world.id[q]; });
  return order;
}

std::string state_hash(const World& world) {
  constexpr std::uint32_t ahead = 16;  // bodies lie in another order than their ids: 8 of 77 ms of a frame of 100 000
  Hash hash;
  for (std::uint32_t b = 0; b < world.ids_given(); ++b) {
    const Slot soon = b + ahead < world.ids_given() ? world.slot_of(static_cast<BodyId>(b + ahead)) : no_slot;
    if (soon != no_slot) {
      prefetch(&world.position[soon], sizeof(Vec3));
      prefetch(&world.velocity[soon], sizeof(Vec3));
      if (world.rotates()) prefetch(&world.angular_velocity[soon], sizeof(Vec3));
    }
    const Slot s = world.slot_of(static_cast<BodyId>(b));
    if (s == no_slot) continue;
    hash.add(b);
    hash.add(world.position[s].data(), 3);
    hash.add(world.velocity[s].data(), 3);
    if (!world.rotates()) continue;
    if (world.has_orientation()) hash.add(world.orientation[s].coeffs().data(), 4);
    hash.add(world.angular_velocity[s].data(), 3);
  }
  return hash.hex();
}

}  // namespace epafi
