#include "laws/smooth/fused/ball_bodies.h"

#include <algorithm>

#include "engine/threads/order_free_sum.h"
#include "engine/threads/parallel.h"
#include "laws/smooth/fused/place_balls.h"

namespace epafi {

void BallBodies::take(std::span<const BodyBall> balls, const World& world) {
  balls_.assign(balls.begin(), balls.end());
  free_.clear();
  held_.clear();
  for (std::uint32_t k = 0; k < balls_.size(); ++k) {
    std::vector<Whole>& all = world.is_movable(balls_[k].body) ? free_ : held_;
    if (all.empty() || all.back().body != balls_[k].body) all.push_back({balls_[k].body, k, 0});
    ++all.back().count;
  }
  offset_.assign(balls_.size(), Vec3::Zero());
  load_.assign(balls_.size(), {});
  used_.clear();
  placed_ = false;
}

bool BallBodies::use(const SpherePairs& pairs) {
  std::vector<std::uint8_t> used(balls_.size(), 0);
  for (std::size_t k = 0; k < used.size(); ++k) used[k] = pairs.first[k + 1] > pairs.first[k] ? 1 : 0;
  for (std::uint32_t i = 0; i < pairs.first[used.size()]; ++i)  // a pair stands at its lower place
    if (pairs.partner[i] < used.size()) used[pairs.partner[i]] = 1;
  const std::vector<std::uint32_t> before = std::exchange(used_, {});
  for (std::uint32_t k = 0; k < used.size(); ++k)
    if (used[k] != 0)
      used_.push_back(k);
    else
      load_[k] = {};
  for (std::vector<Whole>* all : {&free_, &held_})
    for (Whole& w : *all) {
      const auto from = std::ranges::lower_bound(used_, w.first),
                 to = std::ranges::lower_bound(used_, w.first + w.count);
      w.used_first = static_cast<std::uint32_t>(from - used_.begin());
      w.used_count = static_cast<std::uint32_t>(to - from);
    }
  return !std::ranges::includes(before, used_);
}

Slot BallBodies::place_of(Slot body, std::uint32_t part) const {
  for (const std::vector<Whole>* all : {&free_, &held_}) {
    const auto at = std::ranges::lower_bound(*all, body, {}, &Whole::body);
    if (at != all->end() && at->body == body) return part < at->count ? at->first + part : no_slot;
  }
  return part == 0 ? static_cast<Slot>(size()) + body : no_slot;
}

/// Calls f(whole, is free) for bodies with balls in slots [begin, end).
template <class F>
void BallBodies::each_in(std::size_t begin, std::size_t end, const F& f) const {
  for (const std::vector<Whole>* all : {&free_, &held_})
    for (auto w = std::ranges::lower_bound(*all, static_cast<Slot>(begin), {}, &Whole::body);
         w != all->end() && w->body < end; ++w)
      f(*w, all == &free_);
}

void BallBodies::place_one(World& world, const Whole& whole, double lag, Lanes* late_spins) {
  if (whole.used_count == 0) return;
  const Slot s = whole.body;
  const bool rotates = world.rotates(), gives = rotates && world.is_movable(s);
  const Vec3 none = Vec3::Zero();
  place_balls({world.states()[s], world.has_orientation() ? &world.orientation[s] : nullptr,
               rotates ? Vec3(world.angular_velocity[s]) : none, gives ? world.inverse_inertia_of(s) : none,
               gives && lag != 0.0, gives && lag != 0.0 ? Vec3(lag * world.torque[s]) : none,
               world.cell ? world.cell->strain_rate : none,
               std::span(used_).subspan(whole.used_first, whole.used_count), balls_.data(), offset_.data(),
               world.states().data() - world.states_before(), late_spins});
}

void BallBodies::place(World& world, double lag, Lanes* late_spins, std::size_t begin, std::size_t end) {
  each_in(begin, end, [&](const Whole& whole, bool) { place_one(world, whole, lag, late_spins); });
}

void BallBodies::place_all(World& world, double lag, Lanes* late_spins) {
  parallel_blocks(world.size(), 256,
                  [&](std::size_t begin, std::size_t end, std::size_t) { place(world, lag, late_spins, begin, end); });
  placed_ = true;
}

void BallBodies::collect(const World& world, SphereSum* sums, Lanes* moments, std::size_t begin, std::size_t end) {
  static_assert(sizeof(Load) == 6 * sizeof(double));
  const auto from = std::ranges::lower_bound(used_, begin), to = std::ranges::lower_bound(used_, end);
  collect_balls({std::span(from, to), begin, balls_.data(), world.rotates() ? offset_.data() : nullptr, sums, moments,
                 load_.front().force.data()});
}

void BallBodies::give(World& world, std::uint8_t* touched, std::size_t begin, std::size_t end) {
  each_in(begin, end, [&](const Whole& whole, bool free) {
    if (!free) return;  // not needed
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (std::uint32_t k = whole.first; k < whole.first + whole.count; ++k) {
      force += load_[k].force;
      torque += load_[k].torque;
    }
    const bool more = std::exchange(touched[whole.body], std::uint8_t{1}) != 0;
    world.force[whole.body] = more ? Vec3(world.force[whole.body] + force) : force;
    if (world.rotates()) world.torque[whole.body] = more ? Vec3(world.torque[whole.body] + torque) : torque;
  });
}

double BallBodies::driven_power(const World& world) const {
  double power = 0.0;
  for (const Whole& whole : held_) {
    const Vec3 spin = world.rotates() ? Vec3(world.angular_velocity[whole.body]) : Vec3(Vec3::Zero());
    for (std::uint32_t k = whole.first; k < whole.first + whole.count; ++k)
      power -= load_[k].force.dot(world.velocity[whole.body]) + load_[k].torque.dot(spin);
  }
  return power;
}

void BallBodies::add_virial(const World& world, VirialSums& sums) const {
  const VirialSums mine = order_free_totals<3>(balls_.size(), [&](std::size_t k) -> std::array<double, 3> {
    if (!world.owner.empty() && world.owner[balls_[k].body] == World::elsewhere) return {};
    const Vec3 term = load_[k].force.cwiseProduct(offset_[k]);
    return {term.x(), term.y(), term.z()};
  });
  for (std::size_t axis = 0; axis < 3; ++axis) sums[axis] += mine[axis];
}

}  // namespace epafi
