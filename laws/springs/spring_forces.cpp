#include "laws/springs/spring_forces.h"

#include <algorithm>

namespace epafi {
namespace {

/// The far end of a spring at one moment.
struct FarEnd {
  Vec3 point = Vec3::Zero();     ///< where the spring is relaxed [m]
  Mat3 axes = Mat3::Identity();  ///< columns, world axes
  Vec3 velocity = Vec3::Zero();  ///< of the far body or frame at the near end [m/s]
};

class SpringForces final : public ContactLayer {
 public:
  SpringForces(std::vector<SpringElement> springs, std::shared_ptr<const Guideway> way, bool smooth,
               std::unique_ptr<ContactModel> below)
      : ContactLayer(std::move(below)), springs_(std::move(springs)), way_(std::move(way)), smooth_(smooth) {}

  void act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) override;
  void visit(StateVisitor& visitor) override {
    ContactLayer::visit(visitor);
    visitor.column("springs/relaxed", relaxed_), visitor.column("springs/start", start_);
    visitor.value("springs/lost_power", power_.lost), visitor.value("springs/driven_power", power_.driven);
  }

 private:
  struct Power {
    double lost = 0.0, driven = 0.0, elastic = 0.0;  ///< [W], [W], [J]
  };
  struct Pull {
    Vec3 force = Vec3::Zero();
    Vec3 arm = Vec3::Zero(), far_arm = Vec3::Zero();
    Vec3 damper = Vec3::Zero();  ///< part of the force
    FarEnd far;
  };
  void attach(const World& world, const StepClock& clock);
  /// Both its bodies are there still.
  bool holds(const World& world, std::size_t k) const {
    return world.slot_of(springs_[k].body) != no_slot && (!springs_[k].to || world.slot_of(*springs_[k].to) != no_slot);
  }
  /// Of the positions: the end of a smooth step, the middle of a non-smooth one.
  double moment(const World& world, const StepClock& clock) const {
    return world.time + (smooth_ ? 1.0 : 0.5) * clock.dt;
  }
  FarEnd far_end(const World& world, std::size_t k, const Vec3& near, const StepClock& clock) const;
  Pull pull(const World& world, std::size_t k, const StepClock& clock, Power& power) const;
  void push_smooth(World& world, std::size_t k, const Pull& p) const;
  void push_rigid(World& world, std::size_t k, const Pull& p, double dt) const;

  std::vector<SpringElement> springs_;
  std::shared_ptr<const Guideway> way_;
  bool smooth_;
  std::vector<Vec3> relaxed_;  ///< far end in the axes of the far body or frame [m]; empty before the first step
  std::vector<double> start_;  ///< distance of the frame along the way at time 0 [m]
  Power power_;
  std::vector<Pull> pulls_;
};

/// Far ends lie where the near ones are, but for the preload.
void SpringForces::attach(const World& world, const StepClock& clock) {
  const double time = moment(world, clock);
  for (const SpringElement& s : springs_) {
    const Slot a = world.slot_of(s.body);
    const Vec3 near = world.pose(a).to_world(s.attachment);
    Vec3 stretch = Vec3::Zero();
    for (int i = 0; i < 3; ++i)
      if (s.stiffness[i] > 0.0) stretch[i] = s.preload[i] / s.stiffness[i];
    const double distance = s.to ? 0.0 : way_->distance_of(near) - s.speed * time;
    const Pose far = s.to ? world.pose(world.slot_of(*s.to)) : way_->frame(distance + s.speed * time);
    relaxed_.push_back(far.to_local(near) + stretch), start_.push_back(distance);
  }
}

FarEnd SpringForces::far_end(const World& world, std::size_t k, const Vec3& near, const StepClock& clock) const {
  const SpringElement& s = springs_[k];
  if (s.to) {
    const Slot b = world.slot_of(*s.to);
    const Pose pose = world.pose(b);
    const BodyMotion m = motion_at_detection(world, b, clock);
    return {pose.to_world(relaxed_[k]), pose.orientation.toRotationMatrix(),
            m.velocity + m.angular_velocity.cross(near - pose.position)};
  }
  const double at = start_[k] + s.speed * moment(world, clock), h = 1e-3;
  const Pose frame = way_->frame(at);
  const Vec3 seen = frame.to_local(near);
  const Vec3 velocity = s.speed / (2.0 * h) * (way_->frame(at + h).to_world(seen) - way_->frame(at - h).to_world(seen));
  return {frame.to_world(relaxed_[k]), frame.orientation.toRotationMatrix(), velocity};
}

SpringForces::Pull SpringForces::pull(const World& world, std::size_t k, const StepClock& clock, Power& power) const {
  const SpringElement& s = springs_[k];
  const Slot a = world.slot_of(s.body);
  Pull p;
  p.arm = world.pose(a).orientation * s.attachment;
  const Vec3 near = world.position[a] + p.arm;
  p.far = far_end(world, k, near, clock);
  const BodyMotion m = motion_at_detection(world, a, clock);
  const Vec3 stretch = p.far.axes.transpose() * (p.far.point - near),
             rate = p.far.axes.transpose() * (p.far.velocity - m.velocity - m.angular_velocity.cross(p.arm));
  const Vec3 damper = s.damping.cwiseProduct(rate);
  p.damper = p.far.axes * damper;
  p.force = p.far.axes * s.stiffness.cwiseProduct(stretch) + p.damper;
  if (s.to) p.far_arm = near - world.position[world.slot_of(*s.to)];
  power.elastic += 0.5 * stretch.dot(s.stiffness.cwiseProduct(stretch));
  power.lost += damper.dot(rate);
  const bool driven = !s.to || !world.is_movable(world.slot_of(*s.to));
  if (driven) power.driven += p.force.dot(p.far.velocity);
  return p;
}

void SpringForces::push_smooth(World& world, std::size_t k, const Pull& p) const {
  const Slot a = world.slot_of(springs_[k].body);
  world.force[a] += p.force;
  if (world.rotates()) world.torque[a] += p.arm.cross(p.force);
  if (!springs_[k].to) return;
  const Slot b = world.slot_of(*springs_[k].to);
  if (!world.is_movable(b) && !world.columns().held_force) return;
  world.force[b] -= p.force;
  if (world.rotates()) world.torque[b] -= p.far_arm.cross(p.force);
}

void SpringForces::push_rigid(World& world, std::size_t k, const Pull& p, double dt) const {
  const auto kick = [&](Slot s, const Vec3& impulse, const Vec3& arm) {
    if (!world.is_movable(s)) return;
    world.velocity[s] += world.inverse_mass[s] * impulse;
    if (world.rotates()) world.apply_angular_impulse(s, arm.cross(impulse));
  };
  kick(world.slot_of(springs_[k].body), dt * p.force, p.arm);
  if (springs_[k].to) kick(world.slot_of(*springs_[k].to), -dt * p.force, p.far_arm);
}

void SpringForces::act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) {
  if (relaxed_.empty()) attach(world, clock);
  Power now;
  pulls_.assign(springs_.size(), {});
  for (std::size_t k = 0; k < springs_.size(); ++k)
    if (holds(world, k)) pulls_[k] = pull(world, k, clock, now);
  for (std::size_t k = 0; !smooth_ && k < springs_.size(); ++k)
    if (holds(world, k)) push_rigid(world, k, pulls_[k], clock.dt);
  below_->act(world, contacts, clock, report);
  for (std::size_t k = 0; smooth_ && k < springs_.size(); ++k)
    if (holds(world, k)) push_smooth(world, k, pulls_[k]);
  report.elastic += now.elastic;
  report.dissipated += 0.5 * clock.dt * (power_.lost + now.lost);
  report.losses.viscous += 0.5 * clock.dt * (power_.lost + now.lost);
  report.work += 0.5 * clock.dt * (power_.driven + now.driven);
  power_ = now;
}

}  // namespace

std::unique_ptr<ContactModel> make_spring_forces(std::vector<SpringElement> springs,
                                                 std::shared_ptr<const Guideway> way, bool smooth,
                                                 std::unique_ptr<ContactModel> below) {
  return std::make_unique<SpringForces>(std::move(springs), std::move(way), smooth, std::move(below));
}

SpringRates spring_rates(const std::vector<SpringElement>& springs, const World& world) {
  SpringRates most;
  for (const SpringElement& one : springs) {
    const Slot s = world.slot_of(one.body);
    if (s == no_slot || !world.is_movable(s)) continue;
    SpringRates sum;
    for (const SpringElement& k : springs) {
      if (k.body != one.body) continue;
      const double reach = world.rotates() ? k.attachment.squaredNorm() * world.inverse_inertia_of(s).maxCoeff() : 0.0;
      const double mobility = std::max(world.inverse_mass[s], reach);
      sum.square += k.stiffness.maxCoeff() * mobility, sum.damping += k.damping.maxCoeff() * mobility;
    }
    most.square = std::max(most.square, sum.square), most.damping = std::max(most.damping, sum.damping);
  }
  return most;
}

}  // namespace epafi
