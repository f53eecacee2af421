/// @file events.h  What changes the world between steps: driven motion, removal. An ordered list run before the step,
/// never hooks in it.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "engine/state/state_visitor.h"
#include "engine/state/world.h"
#include "engine/step/motion_table.h"

namespace epafi {

class Event {
 public:
  virtual ~Event() = default;
  /// Acts on the state of time t before the step to t + dt; bodies to be taken out are appended to `leaving`.
  virtual void before_step(World& world, double dt, std::vector<BodyId>& leaving) = 0;
  /// Called after before_step(world, dt). True: the next call, after a step as long, neither changes nor reads a body,
  /// so a contact model may begin that step early.
  virtual bool rests_next(const World& /*world*/, double /*dt*/) const { return false; }
  /// It reads only what every process of a run knows, fixed and driven bodies, so each can execute it by itself.
  virtual bool is_local() const { return false; }
  /// A local event that all bodies decide on: every process does `answer` where `asks` is true on some of them.
  virtual bool is_common() const { return false; }
  virtual bool asks(const World&) const { return false; }
  virtual void answer(World&) {}
  virtual void visit(StateVisitor&) {}
};

/// Prescribed motion of a driven body: the sum of a constant velocity, a rotation, an oscillation and a tabulated path,
/// within [from, until].
struct Motion {
  Vec3 velocity = Vec3::Zero();          ///< [m/s]
  Vec3 rotation_axis = Vec3::UnitZ();    ///< unit
  double rotation_rate = 0.0;            ///< [rad/s]
  std::optional<Vec3> rotation_about{};  ///< a point of the axis; the body's own centre where absent [m]
  Vec3 oscillation_direction = Vec3::UnitX();
  double oscillation_amplitude = 0.0;  ///< a in a sin(2 pi f t) [m]
  double oscillation_frequency = 0.0;  ///< f [Hz]
  std::shared_ptr<const MotionTable> table{};
  double from = 0.0;  ///< [s]
  double until = std::numeric_limits<double>::infinity();
};

/// Sets the velocity so that the drift of the step ends exactly on the prescribed path. Several motions act one after
/// the other: what an earlier one has turned or moved, a later one turns about its axis (spin, then orbit) and moves
/// on. Times are those of the stage's clock and what had passed of the motion's own time when the stage began.
class DriveBody final : public Event {
 public:
  /// alone: nothing else moves the body; a servo does.
  DriveBody(BodyId body, std::vector<Motion> motions, const Vec3& start, double elapsed = 0.0, bool alone = true)
      : body_(body), motions_(std::move(motions)), start_(start), elapsed_(elapsed), alone_(alone) {}
  void before_step(World& world, double dt, std::vector<BodyId>& leaving) override;
  bool rests_next(const World& world, double dt) const override;
  bool is_local() const override { return true; }
  void visit(StateVisitor& visitor) override;
  BodyId body() const { return body_; }
  /// Where the body is as its motion begins [m].
  void begin_at(const Vec3& start) { start_ = start; }
  const Vec3& start() const { return start_; }

 private:
  Vec3 position_at(double time) const;
  Quat turn_at(double time) const;
  Vec3 spin(double time, double dt) const;
  bool follows_table() const;
  BodyId body_;
  std::vector<Motion> motions_;
  Vec3 start_;
  double elapsed_;
  bool alone_;
};

/// Takes bodies out at a time [s].
class RemoveBodies final : public Event {
 public:
  /// elapsed: of this time when the present stage began [s].
  RemoveBodies(std::vector<BodyId> bodies, double time, double elapsed = 0.0)
      : bodies_(std::move(bodies)), time_(time), elapsed_(elapsed) {}
  void before_step(World& world, double dt, std::vector<BodyId>& leaving) override;
  bool rests_next(const World& world, double dt) const override;

 private:
  bool is_due(double time, double dt) const { return time + 0.5 * dt >= time_; }
  std::vector<BodyId> bodies_;
  double time_, elapsed_;
};

}  // namespace epafi
