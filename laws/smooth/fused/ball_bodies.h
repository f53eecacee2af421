/// @file ball_bodies.h  Balls of clumps and of held bodies in the loop over spheres. Each has a place before those of
/// the bodies, and a state (position, velocity of its centre, inverse mass) that is computed from its body's before
/// detection. Sums of a ball are added to its body afterwards. So the loop treats balls of clumps as spheres, and free
/// spheres have no additional cost.
#pragma once
#include <span>
#include <vector>

#include "engine/state/body_ball.h"
#include "engine/state/contacts.h"
#include "engine/state/large_column.h"
#include "engine/state/virial.h"
#include "engine/state/world.h"
#include "laws/smooth/fused/sphere_sum.h"

namespace epafi {

class BallBodies {
 public:
  /// Sets the balls.
  void take(std::span<const BodyBall> balls, const World& world);
  const std::vector<BodyBall>& all() const { return balls_; }
  std::size_t size() const { return balls_.size(); }
  bool empty() const { return balls_.empty(); }
  /// True if some belong to free bodies.
  bool any_free() const { return !free_.empty(); }

  /// Ball of a place in the loop.
  Slot body_of(Slot place) const { return place < size() ? balls_[place].body : place - static_cast<Slot>(size()); }
  std::uint32_t part_of(Slot place) const { return place < size() ? balls_[place].part : 0u; }
  bool is_of_clump(Slot place) const { return place < size() && balls_[place].of_clump; }
  /// Vector from the body's centre to the ball's at its last placement, world axes [m].
  Vec3 offset_of(Slot place) const { return place < size() ? offset_[place] : Vec3(Vec3::Zero()); }
  /// By place of balls; null where there are none.
  const Vec3* offsets() const { return offset_.empty() ? nullptr : offset_.data(); }
  /// A column of bodies by place.
  template <class Column>
  void by_place(const Column& of_bodies, Column& out) const {
    out.resize(balls_.size());
    for (std::size_t k = 0; k < balls_.size(); ++k) out[k] = of_bodies[balls_[k].body];
    out.insert(out.end(), of_bodies.begin(), of_bodies.end());
  }
  /// no_slot: the body has no such ball.
  Slot place_of(Slot body, std::uint32_t part) const;

  /// Bodies have moved or have other slots: balls must be placed before the next detection.
  void forget_places() { placed_ = false; }
  void set_placed() { placed_ = true; }
  bool placed() const { return placed_; }
  /// Sets the balls that have a listed pair; others are not placed. True if some were not used before.
  bool use(const SpherePairs& pairs);
  /// Writes the states of the balls of bodies in slots [begin, end) and, where it is not null, `late_spins` by place.
  /// Velocities of the bodies' states, and those predicted `lag` later, are known.
  void place(World& world, double lag, Lanes* late_spins, std::size_t begin, std::size_t end);
  void place_all(World& world, double lag, Lanes* late_spins);

  /// Collects sums and moments (or null) of the balls from place `begin` on, and resets them to 0.
  void collect(const World& world, SphereSum* sums, Lanes* moments, std::size_t begin, std::size_t end);
  /// Adds the collected loads to the forces of bodies in slots [begin, end), or sets these if `touched` is 0 there, and
  /// then sets it.
  void give(World& world, std::uint8_t* touched, std::size_t begin, std::size_t end);
  /// Power of held bodies on the others, by the last collected loads [W].
  double driven_power(const World& world) const;
  /// Sum of force times offset over all balls, by axis [N m]: virial of bodies minus that of balls. With several
  /// processes: over this one's bodies.
  void add_virial(const World& world, VirialSums& sums) const;

 private:
  /// A body and its balls.
  struct Whole {
    Slot body;
    std::uint32_t first, count;
    std::uint32_t used_first = 0, used_count = 0;  ///< in used_
  };
  struct Load {
    Vec3 force = Vec3::Zero();   ///< [N]
    Vec3 torque = Vec3::Zero();  ///< about the body's centre [N m]
  };
  template <class F>
  void each_in(std::size_t begin, std::size_t end, const F& f) const;
  void place_one(World& world, const Whole& whole, double lag, Lanes* late_spins);

  std::vector<BodyBall> balls_;
  std::vector<Whole> free_, held_;   ///< by slot
  std::vector<std::uint32_t> used_;  ///< balls that have a listed pair, ascending
  std::vector<Vec3> offset_;         ///< by ball, world axes [m]
  std::vector<Load> load_;           ///< by ball
  bool placed_ = false;
};

}  // namespace epafi
