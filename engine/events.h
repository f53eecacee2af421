/// @file events.h  What changes the world between steps: driven motion, removal. An ordered list run before the step,
/// never hooks in it.
#pragma once
#include <optional>
#include <vector>

#include "engine/state_visitor.h"
#include "engine/world.h"

namespace epafi {

class Event {
 public:
  virtual ~Event() = default;
  /// Acts on the state of time t before the step to t + dt; bodies to be taken out are appended to `leaving`.
  virtual void before_step(World& world, double dt, std::vector<BodyId>& leaving) = 0;
  /// Asked behind before_step(world, dt): the next call, as long a step later, will change nothing and look at no body.
  /// A contact model may begin that step before it then.
  virtual bool rests_next(const World& /*world*/, double /*dt*/) const { return false; }
  virtual void visit(StateVisitor&) {}
};

/// Prescribed motion of a driven body: the sum of a constant velocity, a rotation and an oscillation, within [from,
/// until].
struct Motion {
  Vec3 velocity = Vec3::Zero();          ///< [m/s]
  Vec3 rotation_axis = Vec3::UnitZ();    ///< unit
  double rotation_rate = 0.0;            ///< [rad/s]
  std::optional<Vec3> rotation_about{};  ///< a point of the axis; the body's own centre where absent [m]
  Vec3 oscillation_direction = Vec3::UnitX();
  double oscillation_amplitude = 0.0;  ///< a in a sin(2 pi f t) [m]
  double oscillation_frequency = 0.0;  ///< f [Hz]
  double from = 0.0;                   ///< [s]
  double until = std::numeric_limits<double>::infinity();
};

/// Sets the velocity so that the drift of the step ends exactly on the prescribed path.
class DriveBody final : public Event {
 public:
  DriveBody(BodyId body, Motion motion, const Vec3& start) : body_(body), motion_(motion), start_(start) {}
  void before_step(World& world, double dt, std::vector<BodyId>& leaving) override;
  bool rests_next(const World& world, double dt) const override;

 private:
  Vec3 position_at(double time) const;
  double active_time(double time) const;
  BodyId body_;
  Motion motion_;
  Vec3 start_;
};

/// Takes bodies out at a time [s].
class RemoveBodies final : public Event {
 public:
  RemoveBodies(std::vector<BodyId> bodies, double time) : bodies_(std::move(bodies)), time_(time) {}
  void before_step(World& world, double dt, std::vector<BodyId>& leaving) override;
  bool rests_next(const World& world, double dt) const override;

 private:
  bool is_due(double time, double dt) const { return time + 0.5 * dt >= time_; }
  std::vector<BodyId> bodies_;
  double time_;
};

}  // namespace epafi
