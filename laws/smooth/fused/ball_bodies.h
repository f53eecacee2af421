/// @file ball_bodies.h  Balls of clumps and of held bodies in the loop over spheres. Each has a place and a state of
/// its own before those of the bodies, written from its body's before the contacts are found: where the ball is, how
/// fast its centre moves, how easily its body gives. What the loop finds for a ball goes to its body afterwards. A ball
/// of a clump that touches is thus a sphere to the loop; a free sphere is its own body and pays nothing.
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
  /// Those of a list from now on.
  void take(std::span<const BodyBall> balls, const World& world);
  const std::vector<BodyBall>& all() const { return balls_; }
  std::size_t size() const { return balls_.size(); }
  bool empty() const { return balls_.empty(); }
  /// Some belong to bodies that move by what they feel.
  bool any_free() const { return !free_.empty(); }

  /// Of a place in the loop.
  Slot body_of(Slot place) const { return place < size() ? balls_[place].body : place - static_cast<Slot>(size()); }
  std::uint32_t part_of(Slot place) const { return place < size() ? balls_[place].part : 0u; }
  bool is_of_clump(Slot place) const { return place < size() && balls_[place].of_clump; }
  /// From the body's centre to the ball's, where it was placed last, world axes [m].
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

  /// Bodies stand elsewhere, or other ones in their slots: they are to be placed before the next contacts.
  void forget_places() { placed_ = false; }
  void set_placed() { placed_ = true; }
  bool placed() const { return placed_; }
  /// Those that have a listed pair: the others are not placed and feel nothing. True where some were not used before.
  bool use(const SpherePairs& pairs);
  /// Writes the states of the balls of bodies in slots [begin, end) and, where it is not null, `late_spins` by place.
  /// Velocities of the bodies' states, and those predicted `lag` later, are known.
  void place(World& world, double lag, Lanes* late_spins, std::size_t begin, std::size_t end);
  void place_all(World& world, double lag, Lanes* late_spins);

  /// Takes what was found for the balls from place `begin` on: sums and moments (or null), 0 again then.
  void collect(const World& world, SphereSum* sums, Lanes* moments, std::size_t begin, std::size_t end);
  /// Adds it to the forces of bodies in slots [begin, end), or, where `touched` does not say that there are some, puts
  /// it in their place, and says so.
  void give(World& world, std::uint8_t* touched, std::size_t begin, std::size_t end);
  /// Of held bodies on the others, by what was collected last [W].
  double driven_power(const World& world) const;
  /// Sum of force times offset over all balls, by axis [N m]: by it the virial of bodies exceeds that of balls.
  /// Of several processes of bodies that are not others'.
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
