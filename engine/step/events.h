/// @file events.h  Changes of the world between steps: driven motion, removal. An ordered list that runs before the
/// step.
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
  /// Acts on the state of time t before the step to t + dt; appends bodies to remove to `leaving`.
  virtual void before_step(World& world, double dt, std::vector<BodyId>& leaving) = 0;
  /// Called after before_step(world, dt). True if the next call, after a step of the same length, neither changes nor
  /// reads a body; a contact model may then begin that step early.
  virtual bool rests_next(const World& /*world*/, double /*dt*/) const { return false; }
  /// True if it reads only fixed and driven bodies, which every process of a run has, so that each can execute it.
  virtual bool is_local() const { return false; }
  /// True for a local event that depends on all bodies: every process calls `answer` if `asks` is true on any of them.
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

/// Sets the velocity so that the drift of the step ends exactly on the prescribed path. Several motions are applied one
/// after the other: a later one rotates and moves the result of the earlier ones (spin, then orbit). Times count from
/// the stage's start, plus `elapsed`, the motion's own time before it.
class DriveBody final : public Event {
 public:
  /// alone: no servo moves the body too.
  DriveBody(BodyId body, std::vector<Motion> motions, const Vec3& start, double elapsed = 0.0, bool alone = true)
      : body_(body), motions_(std::move(motions)), start_(start), elapsed_(elapsed), alone_(alone) {}
  void before_step(World& world, double dt, std::vector<BodyId>& leaving) override;
  bool rests_next(const World& world, double dt) const override;
  bool is_local() const override { return true; }
  void visit(StateVisitor& visitor) override;
  BodyId body() const { return body_; }
  /// Sets the position of the body at the start of its motion [m].
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

/// Removes bodies at a time [s].
class RemoveBodies final : public Event {
 public:
  /// elapsed: time that had passed when the present stage began [s].
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
