#include "laws/springs/spring_forces.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/ranks/shared_model.h"
#include "engine/state/rotation.h"

namespace epafi {
namespace {

/// The far end of a spring at one moment.
struct FarEnd {
  Vec3 point = Vec3::Zero();     ///< where the spring is relaxed [m]
  Mat3 axes = Mat3::Identity();  ///< columns, world axes
  Vec3 velocity = Vec3::Zero();  ///< of the far body or frame at the near end [m/s]
};

class SpringForces final : public ContactLayer, public SharedModel {
 public:
  SpringForces(std::vector<SpringElement> springs, std::shared_ptr<const Guideway> way, bool smooth,
               std::unique_ptr<ContactModel> below)
      : ContactLayer(std::move(below)), springs_(std::move(springs)), way_(std::move(way)), smooth_(smooth) {}

  void act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) override;
  void store(const World& world, StepReport& report) override;
  void visit(StateVisitor& visitor) override {
    ContactLayer::visit(visitor);
    attached_ = false;  // it may be another state that comes in
    visitor.column("springs/relaxed", relaxed_);
    visitor.column("springs/start", start_);
    visitor.share("springs/lost_power", balance_.lost);
    visitor.share("springs/driven_power", balance_.driven);
  }
  void add_virial(const World& world, Virial& virial) const override {
    if (const auto* below = dynamic_cast<const SharedModel*>(below_.get())) below->add_virial(world, virial);
  }
  void append_held_pulls(const World& world, std::vector<HeldPull>& pulls) const override;

 private:
  struct Balance {
    double lost = 0.0, driven = 0.0, elastic = 0.0;  ///< [W], [W], [J]
  };
  struct Pull {
    Vec3 force = Vec3::Zero();
    Vec3 arm = Vec3::Zero(), far_arm = Vec3::Zero();
    Vec3 damper = Vec3::Zero();  ///< part of the force
    Vec3 rate = Vec3::Zero();    ///< of the stretch, world axes [m/s]
    Vec3 flow = Vec3::Zero();    ///< its part from the strain of the cell [m/s]
    FarEnd far;
  };
  void attach(const World& world, double time);
  /// Both its bodies are there still.
  bool holds(const World& world, std::size_t k) const {
    return world.slot_of(springs_[k].body) != no_slot && (!springs_[k].to || world.slot_of(*springs_[k].to) != no_slot);
  }
  /// And one of them is no ghost here.
  bool acts(const World& world, std::size_t k) const {
    if (!holds(world, k)) return false;
    const auto is_here = [&](BodyId body) { return world.owner[world.slot_of(body)] == World::here; };
    return world.owner.empty() || is_here(springs_[k].body) || (springs_[k].to && is_here(*springs_[k].to));
  }
  /// By one process of several: the owner of the first body, which is free.
  bool counts(const World& world, std::size_t k) const {
    return world.owner.empty() || world.owner[world.slot_of(springs_[k].body)] == World::here;
  }
  /// The second one is fixed or driven, and forces on such bodies are wanted.
  bool pulls_held(const World& world, std::size_t k) const {
    return springs_[k].to && world.columns().held_force && !world.is_movable(world.slot_of(*springs_[k].to));
  }
  /// Of the positions: the end of a smooth step, the middle of a non-smooth one.
  double time_of_forces(const World& world, const StepClock& clock) const {
    return world.clock + (smooth_ ? 1.0 : 0.5) * clock.dt;
  }
  FarEnd far_end(const World& world, std::size_t k, const Vec3& near, const StepClock& clock) const;
  Pull pull(const World& world, std::size_t k, const StepClock& clock, Balance& balance) const;
  void push_smooth(World& world, std::size_t k, const Pull& p) const;
  void act_smooth(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report);
  void act_rigid(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report);
  void push_rigid(const World& world, std::size_t k, const Pull& p, double dt);
  Vec3 rate_now(const World& world, std::size_t k, const Pull& p) const;
  /// Of the stretch, by a frame or driven body and by the strain of the cell; world axes [m/s].
  Vec3 driven_rate(const World& world, std::size_t k, const Pull& p) const {
    const bool driven = !springs_[k].to || !world.is_movable(world.slot_of(*springs_[k].to));
    return driven ? Vec3(p.flow + p.far.velocity) : p.flow;
  }
  double stored(const World& world, std::size_t k, double ahead) const;

  std::vector<SpringElement> springs_;
  std::shared_ptr<const Guideway> way_;
  bool smooth_;
  bool attached_ = false;
  std::vector<Vec3> relaxed_;  ///< far end in the axes of the far body or frame [m]; empty before the first step
  std::vector<double> start_;  ///< distance of the frame along the way at time 0 [m]
  Balance balance_;
  std::vector<Pull> pulls_;
  Pushes pushes_;  ///< of a non-smooth step
};

/// Velocity that the strain of the cell gives a body beside its own, along its unwrapped path [m/s].
Vec3 flow_of_cell(const World& world, Slot s) {
  if (!world.cell) return Vec3::Zero();
  return world.cell->strain_rate.cwiseProduct(world.unwrapped(s) - world.cell->low);
}

/// The pose after the body went on for `ahead` [s] as it moves now.
Pose pose_ahead(const World& world, Slot s, double ahead) {
  Pose pose = unwrapped_pose(world, s);
  pose.position += ahead * world.velocity[s];
  if (world.has_orientation()) pose.orientation = turned(pose.orientation, ahead * world.angular_velocity[s]);
  return pose;
}

/// Far ends lie where the near ones are, but for the preload; those of springs that have been carried over stay.
void SpringForces::attach(const World& world, double time) {
  if (attached_) return;
  attached_ = true;
  relaxed_.resize(springs_.size(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  start_.resize(springs_.size());
  for (std::size_t k = 0; k < springs_.size(); ++k) {
    const SpringElement& s = springs_[k];
    if (relaxed_[k].allFinite() || !holds(world, k)) continue;
    const Slot a = world.slot_of(s.body);
    const Vec3 near = unwrapped_pose(world, a).to_world(s.attachment);
    Vec3 stretch = Vec3::Zero();
    for (int i = 0; i < 3; ++i)
      if (s.stiffness[i] > 0.0) stretch[i] = s.preload[i] / s.stiffness[i];
    const double distance = s.to ? 0.0 : way_->distance_of(near) - s.speed * time;
    const Pose far = s.to ? unwrapped_pose(world, world.slot_of(*s.to)) : way_->frame(distance + s.speed * time);
    relaxed_[k] = far.to_local(near) + stretch;
    start_[k] = distance;
  }
}

FarEnd SpringForces::far_end(const World& world, std::size_t k, const Vec3& near, const StepClock& clock) const {
  const SpringElement& s = springs_[k];
  if (s.to) {
    const Slot b = world.slot_of(*s.to);
    const Pose pose = unwrapped_pose(world, b);
    const BodyMotion m = motion_at_detection(world, b, clock);
    return {pose.to_world(relaxed_[k]), pose.orientation.toRotationMatrix(),
            m.velocity + m.angular_velocity.cross(near - pose.position)};
  }
  const double at = start_[k] + s.speed * time_of_forces(world, clock), h = 1e-3;
  const Pose frame = way_->frame(at);
  const Vec3 seen = frame.to_local(near);
  const Vec3 velocity = s.speed / (2.0 * h) * (way_->frame(at + h).to_world(seen) - way_->frame(at - h).to_world(seen));
  return {frame.to_world(relaxed_[k]), frame.orientation.toRotationMatrix(), velocity};
}

SpringForces::Pull SpringForces::pull(const World& world, std::size_t k, const StepClock& clock,
                                      Balance& balance) const {
  const SpringElement& s = springs_[k];
  const Slot a = world.slot_of(s.body);
  Pull p;
  p.arm = world.pose(a).orientation * s.attachment;
  const Vec3 near = world.unwrapped(a) + p.arm;
  p.far = far_end(world, k, near, clock);
  p.flow = (s.to ? flow_of_cell(world, world.slot_of(*s.to)) : Vec3::Zero()) - flow_of_cell(world, a);
  const BodyMotion m = motion_at_detection(world, a, clock);
  const Vec3 stretch = p.far.axes.transpose() * (p.far.point - near),
             rate = p.far.axes.transpose() * (p.far.velocity + p.flow - m.velocity - m.angular_velocity.cross(p.arm));
  const Vec3 damper = s.damping.cwiseProduct(rate);
  p.damper = p.far.axes * damper;
  p.rate = p.far.axes * rate;
  p.force = p.far.axes * s.stiffness.cwiseProduct(stretch) + p.damper;
  if (s.to) p.far_arm = near - world.unwrapped(world.slot_of(*s.to));
  balance.elastic += 0.5 * stretch.dot(s.stiffness.cwiseProduct(stretch));
  balance.lost += damper.dot(rate);
  balance.driven += p.force.dot(driven_rate(world, k, p));
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

void SpringForces::push_rigid(const World& world, std::size_t k, const Pull& p, double dt) {
  const auto push = [&](Slot s, const Vec3& impulse, const Vec3& arm) {
    if (!world.is_movable(s)) return;
    pushes_.linear[s] += impulse;
    if (world.rotates()) pushes_.angular[s] += arm.cross(impulse);
  };
  push(world.slot_of(springs_[k].body), dt * p.force, p.arm);
  if (springs_[k].to) push(world.slot_of(*springs_[k].to), -dt * p.force, p.far_arm);
}

/// Of the stretch, by the velocities of now at the places of the pull; world axes [m/s].
Vec3 SpringForces::rate_now(const World& world, std::size_t k, const Pull& p) const {
  const auto at = [&](Slot s, const Vec3& arm) -> Vec3 {
    return world.rotates() ? Vec3(world.velocity[s] + world.angular_velocity[s].cross(arm)) : world.velocity[s];
  };
  const Vec3 near = at(world.slot_of(springs_[k].body), p.arm);
  return springs_[k].to ? Vec3(at(world.slot_of(*springs_[k].to), p.far_arm) - near) : Vec3(p.far.velocity - near);
}

/// k d^2/2 of one spring, `ahead` [s] after the present positions; the frame's time is world.clock + 2 ahead, as
/// positions are those of the middle of the step where ahead is half of it.
double SpringForces::stored(const World& world, std::size_t k, double ahead) const {
  const SpringElement& s = springs_[k];
  const Vec3 near = pose_ahead(world, world.slot_of(s.body), ahead).to_world(s.attachment);
  const Pose far = s.to ? pose_ahead(world, world.slot_of(*s.to), ahead)
                        : way_->frame(start_[k] + s.speed * (world.clock + 2.0 * ahead));
  const Vec3 stretch = far.orientation.conjugate() * (far.to_world(relaxed_[k]) - near);
  return 0.5 * stretch.dot(s.stiffness.cwiseProduct(stretch));
}

void SpringForces::store(const World& world, StepReport& report) {
  below_->store(world, report);
  attach(world, world.clock);
  for (std::size_t k = 0; k < springs_.size(); ++k)
    if (holds(world, k)) report.elastic += stored(world, k, 0.0);
}

void SpringForces::act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) {
  attach(world, time_of_forces(world, clock));
  if (smooth_)
    act_smooth(world, contacts, clock, report);
  else
    act_rigid(world, contacts, clock, report);
}

void SpringForces::act_smooth(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) {
  Balance now;
  pulls_.assign(springs_.size(), {});
  Balance counted_elsewhere;
  for (std::size_t k = 0; k < springs_.size(); ++k)
    if (acts(world, k)) pulls_[k] = pull(world, k, clock, counts(world, k) ? now : counted_elsewhere);
  below_->act(world, contacts, clock, report);
  for (std::size_t k = 0; k < springs_.size(); ++k)
    if (acts(world, k)) push_smooth(world, k, pulls_[k]);
  report.elastic += now.elastic;
  report.dissipated += 0.5 * clock.dt * (balance_.lost + now.lost);
  report.losses.viscous += 0.5 * clock.dt * (balance_.lost + now.lost);
  report.work += 0.5 * clock.dt * (balance_.driven + now.driven);
  balance_ = now;
}

void SpringForces::append_held_pulls(const World& world, std::vector<HeldPull>& pulls) const {
  for (std::size_t k = 0; k < pulls_.size(); ++k) {
    if (!holds(world, k) || !counts(world, k) || !pulls_held(world, k)) continue;
    HeldPull& pull = pulls.emplace_back(HeldPull{k, *springs_[k].to});
    const Vec3 &force = pulls_[k].force, torque = pulls_[k].far_arm.cross(force);
    std::copy_n(force.data(), 3, pull.force);
    std::copy_n(torque.data(), 3, pull.torque);
  }
}

/// The impulses change v_k to v_k+1 together with those of contacts: what they do is by the mean of both velocities.
void SpringForces::act_rigid(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) {
  Balance unused;
  pulls_.assign(springs_.size(), {});
  pushes_.linear.assign(world.size(), Vec3::Zero());
  pushes_.angular.assign(world.rotates() ? world.size() : 0, Vec3::Zero());
  for (std::size_t k = 0; k < springs_.size(); ++k) {
    if (!holds(world, k)) continue;
    pulls_[k] = pull(world, k, clock, unused);
    push_rigid(world, k, pulls_[k], clock.dt);
  }
  StepClock with_springs = clock;
  with_springs.pushes = &pushes_;
  below_->act(world, contacts, with_springs, report);
  for (std::size_t k = 0; k < springs_.size(); ++k) {
    if (!holds(world, k)) continue;
    const Pull& p = pulls_[k];
    const double lost = 0.5 * clock.dt * p.damper.dot(p.rate + rate_now(world, k, p));
    report.elastic += stored(world, k, 0.5 * clock.dt);
    report.dissipated += lost;
    report.losses.viscous += lost;
    report.work += clock.dt * p.force.dot(driven_rate(world, k, p));
  }
}

}  // namespace

std::unique_ptr<ContactModel> make_spring_forces(std::vector<SpringElement> springs,
                                                 std::shared_ptr<const Guideway> way, bool smooth,
                                                 std::unique_ptr<ContactModel> below) {
  return std::make_unique<SpringForces>(std::move(springs), std::move(way), smooth, std::move(below));
}

namespace {

/// M^-1/2 of a free body, and where its part of a vector over all free bodies begins.
struct MassRoot {
  double linear = 0.0;
  Mat3 angular = Mat3::Zero();
};

/// J^T D J of springs in the velocities M^1/2 v, with D their stiffness or damping: symmetric, its largest eigenvalue
/// is that of M^-1 J^T D J. Positions and axes are those of the moment.
class SpringOperator {
 public:
  SpringOperator(const std::vector<SpringElement>& springs, const World& world, const Guideway& way) : world_(world) {
    roots_.resize(world.size());
    for (Slot s = 0; s < world.size(); ++s) load(s);
    for (const SpringElement& s : springs) {
      const Slot a = world.slot_of(s.body), b = s.to ? world.slot_of(*s.to) : no_slot;
      if (a == no_slot || (s.to && b == no_slot)) continue;
      const Vec3 arm = world.pose(a).orientation * s.attachment, near = world.unwrapped(a) + arm;
      const Quat axes = s.to ? world.pose(b).orientation : way.frame(way.distance_of(near)).orientation;
      ends_.push_back({a, b, arm, s.to ? Vec3(near - world.unwrapped(b)) : Vec3(Vec3::Zero()), axes.toRotationMatrix(),
                       s.stiffness, s.damping});
    }
  }

  /// By balance iteration: after n steps on vectors of m entries the quotient is below the eigenvalue by log(m)/2n at
  /// most.
  double largest(bool damping) const {
    constexpr int most_iterations = 300;
    std::vector<Vec6> x(world_.size(), Vec6::Zero()), y;
    for (std::size_t k = 0; k < ends_.size(); ++k)
      for (const Slot s : {ends_[k].a, ends_[k].b})
        if (s != no_slot) x[s] += Vec6(1.0, 0.83, 0.71, 0.61, 0.53, 0.47) / (1.0 + 0.37 * static_cast<double>(k));
    double value = 0.0;
    for (int k = 0; k < most_iterations; ++k) {
      apply(x, damping, y);
      double size = 0.0, along = 0.0;
      for (std::size_t s = 0; s < x.size(); ++s) {
        size += x[s].squaredNorm();
        along += x[s].dot(y[s]);
      }
      if (!(size > 0.0) || !(along > 0.0)) return value;
      value = along / size;
      for (Vec6& v : y) v /= value;
      x.swap(y);
    }
    return value;
  }

 private:
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  struct End {
    Slot a, b;
    Vec3 arm_a, arm_b;
    Mat3 axes;
    Vec3 stiffness, damping;
  };
  void load(Slot s) {
    if (!world_.is_movable(s)) return;
    roots_[s].linear = std::sqrt(world_.inverse_mass[s]);
    if (!world_.rotates()) return;
    const Mat3 turn = world_.pose(s).orientation.toRotationMatrix();
    roots_[s].angular = turn * world_.inverse_inertia_of(s).cwiseSqrt().asDiagonal() * turn.transpose();
  }
  void apply(const std::vector<Vec6>& x, bool damping, std::vector<Vec6>& y) const {
    y.assign(x.size(), Vec6::Zero());
    const auto velocity = [&](Slot s, const Vec3& arm) -> Vec3 {
      return roots_[s].linear * x[s].head<3>() + Vec3(roots_[s].angular * x[s].tail<3>()).cross(arm);
    };
    const auto push = [&](Slot s, const Vec3& arm, const Vec3& force) {
      y[s].head<3>() += roots_[s].linear * force;
      y[s].tail<3>() += roots_[s].angular * arm.cross(force);
    };
    for (const End& e : ends_) {
      Vec3 rate = velocity(e.a, e.arm_a);
      if (e.b != no_slot) rate -= velocity(e.b, e.arm_b);
      const Vec3 force = e.axes * (damping ? e.damping : e.stiffness).cwiseProduct(e.axes.transpose() * rate);
      push(e.a, e.arm_a, force);
      if (e.b != no_slot) push(e.b, e.arm_b, -force);
    }
  }

  const World& world_;
  std::vector<MassRoot> roots_;
  std::vector<End> ends_;
};

}  // namespace

SpringRates spring_rates(const std::vector<SpringElement>& springs, const World& world, const Guideway& way) {
  if (springs.empty()) return {};
  const SpringOperator all(springs, world, way);
  return {all.largest(false), all.largest(true)};
}

double impulse_limit(const SpringRates& rates) {
  const double c = rates.damping, sum = c + std::sqrt(c * c + 4.0 * rates.square);
  return sum > 0.0 ? 4.0 / sum : std::numeric_limits<double>::infinity();
}

}  // namespace epafi
