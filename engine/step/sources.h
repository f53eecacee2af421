/// @file sources.h  Sources add bodies during a run, outlets remove and count them.
#pragma once
#include <functional>
#include <limits>
#include <string>

#include "engine/step/events.h"

namespace epafi {

/// A body that waits to be poured.
struct WaitingBody {
  Body body;            ///< its position is chosen when it enters
  BodyId id{};          ///< reserved
  double time = 0.0;    ///< not before [s]
  double radius = 0.0;  ///< of its bounding sphere [m]
};

/// Adds bodies in their order, each at its time or as soon as there is room: at the first of 20 places of a step where
/// its bounding sphere meets no other free body's and it overlaps no fixed or driven body. Places are random functions
/// of (seed, body, step), so a restart gives the same.
class PourBodies final : public Event {
 public:
  struct Setup {
    std::string name;  ///< of the fill, unique
    std::vector<WaitingBody> bodies;
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();  ///< the box [m]
    std::uint64_t seed = 1;
    std::function<double(std::uint32_t shape)> radius;  ///< bounding radius of World::shape [m]
    std::function<void(const World&)>
        see_held;  ///< called before `meets_held`: reads the present fixed and driven bodies
    std::function<bool(const Body&)> meets_held;  ///< the body would overlap one of them
    double elapsed = 0.0;                         ///< of its time when the present stage began [s]
  };
  explicit PourBodies(Setup setup) : setup_(std::move(setup)) {}
  void before_step(World& world, double dt, std::vector<BodyId>& leaving) override;
  bool rests_next(const World& world, double dt) const override { return !waits(world.clock + setup_.elapsed + dt); }
  void visit(StateVisitor& visitor) override;
  const Setup& setup() const { return setup_; }
  std::uint64_t poured() const { return next_; }
  /// Number of bodies due by now.
  std::uint64_t due(const World& world) const;

  /// True if a body is due.
  bool waits(double time) const { return next_ < setup_.bodies.size() && setup_.bodies[next_].time <= time; }

 private:
  Setup setup_;
  std::uint64_t next_ = 0;   ///< body to be poured next
  std::uint64_t tried_ = 0;  ///< steps in which there was no room for it
};

/// Bodies that an outlet has removed.
struct Tally {
  double count = 0.0, mass = 0.0;  ///< [-], [kg]
};

/// Takes out every free body whose centre is in a box, and counts it. A removal reorders all bodies, pairs and springs.
/// So it acts every `steps` steps, or in the time in which the fastest body moves by a fiftieth of the box's thinnest
/// side, so that no body gets far inside or through.
class Outlet final : public Event {
 public:
  Outlet(std::string name, const Vec3& low, const Vec3& high, int steps = 1)
      : name_(std::move(name)), low_(low), high_(high), steps_(steps) {}
  void before_step(World& world, double dt, std::vector<BodyId>& leaving) override;
  bool rests_next(const World& world, double dt) const override { return !is_due(world.time + dt, dt); }
  void visit(StateVisitor& visitor) override;
  const std::string& name() const { return name_; }
  const Tally& tally() const { return tally_; }

 private:
  bool is_due(double time, double dt) const {
    return time + 0.5 * dt >= next_look_ || time + (steps_ + 0.5) * dt < next_look_;  // the second: another clock
  }
  double wait(const World& world, double dt) const;

  std::string name_;
  Vec3 low_, high_;
  int steps_;
  double next_look_ = -std::numeric_limits<double>::infinity();  ///< World::time [s]
  Tally tally_;
};

}  // namespace epafi
