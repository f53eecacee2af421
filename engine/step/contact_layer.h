/// @file contact_layer.h  A contact model that lets another one act first and adds forces of its own.
#pragma once
#include <memory>
#include <utility>

#include "engine/step/pipeline.h"

namespace epafi {

class ContactLayer : public ContactModel {
 public:
  explicit ContactLayer(std::unique_ptr<ContactModel> below) : below_(std::move(below)) {}
  const char* name() const override { return below_->name(); }
  void reorder(const Reordering& change) override { below_->reorder(change); }
  void visit(StateVisitor& visitor) override { below_->visit(visitor); }
  void store(const World& world, StepReport& report) override { below_->store(world, report); }
  void publish(const World& world, ContactSet& contacts) const override { below_->publish(world, contacts); }
  std::size_t own_parts() const override { return below_->own_parts(); }
  std::optional<std::size_t> own_count(std::size_t part) const override { return below_->own_count(part); }
  void append_gaps(const World& world, std::size_t part, ContactSet& gaps) const override {
    below_->append_gaps(world, part, gaps);
  }
  void append_contacts(const World& world, std::size_t part, const Wanted& wanted,
                       ContactSet& contacts) const override {
    below_->append_contacts(world, part, wanted, contacts);
  }
  const ContactModel& below() const { return *below_; }

 protected:
  std::unique_ptr<ContactModel> below_;
};

/// Velocities of a free body at the time of the detection, by the stored acceleration (StepClock::velocity_lag).
struct BodyMotion {
  Vec3 velocity, angular_velocity;
};
inline BodyMotion motion_at_detection(const World& world, Slot s, const StepClock& clock) {
  BodyMotion m{world.velocity[s], world.rotates() ? world.angular_velocity[s] : Vec3(Vec3::Zero())};
  const double lag = clock.velocity_lag * clock.dt;
  if (lag == 0.0 || !world.is_movable(s)) return m;
  m.velocity += lag * world.acceleration(s);
  if (world.rotates()) m.angular_velocity += lag * world.apply_inverse_inertia(s, world.torque[s]);
  return m;
}

}  // namespace epafi
