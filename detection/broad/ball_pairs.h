/// @file ball_pairs.h  Pairs of the balls of clumps and held spheres, in PairList::spheres. While a list of bodies is
/// valid no point of a body moves by more than half the body's margin, so a list of balls with the bodies' margins
/// lasts as long.
#pragma once
#include <span>

#include "detection/broad/fat_bodies.h"
#include "detection/broad/sphere_roles.h"
#include "engine/state/body_ball.h"

namespace epafi {

/// Balls of all bodies with a role, in the order of their slots.
std::vector<BodyBall> find_balls(const World& world, const ShapeStore& shapes, const SphereRoles& roles);

class BallPairs {
 public:
  std::size_t size() const { return balls_.size(); }
  /// Moves pairs of such bodies with each other, with free spheres and, without a cell, with planes from a complete
  /// list to `spheres`, whose places they shift by the number of balls. same_bodies: in the same slots as at the last
  /// call.
  void take(const World& world, const BroadSetup& setup, const FatBodies& bodies, bool same_bodies, PairList& pairs);
  /// The same for free spheres that came since, behind the others.
  void take_more(const World& world, const BroadSetup& setup, const FatBodies& bodies, PairList& pairs);

 private:
  struct Placed {
    Vec3 centre;    ///< [m]
    double radius;  ///< [m]
  };
  struct Partner {
    Slot place;
    std::uint32_t image;
  };
  /// Input of all these calls.
  struct Call {
    const World& world;
    const BroadSetup& setup;
    const FatBodies& bodies;
    const PairList& list;
  };
  void read_bodies(const World& world, const BroadSetup& setup);
  void place_balls(const World& world);
  bool takes(const World& world, const Pair& p) const;
  void drop_taken(const World& world, PairList& pairs) const;
  /// The balls of a body and the place of the first one; `one`: room for that of a free sphere.
  std::span<const Placed> balls_of(const Call& call, Slot s, Placed& one) const;
  Slot first_place(Slot s) const;
  template <class F>
  void each_near(const Call& call, const Pair& p, const F& f) const;
  template <class F>
  void each_on_plane(const Call& call, const Pair& p, const F& f) const;
  template <class F>
  void each_ball_pair(const Call& call, const Pair& p, const F& f) const;
  void join(std::size_t bodies, SpherePairs& list);

  std::vector<SphereRole> role_;  ///< by slot
  std::vector<BodyBall> balls_;
  std::vector<std::uint32_t> first_;  ///< by slot, of bodies that have some: the first of their balls
  std::vector<std::uint32_t> count_;  ///< by slot: how many
  std::vector<Placed> placed_;
  std::vector<std::uint32_t> begin_;  ///< by ball, of its partners
  UnwrittenColumn<Slot> partner_;
  UnwrittenColumn<std::uint32_t> image_;
};

}  // namespace epafi
