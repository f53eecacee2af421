#include "laws/nonsmooth/driven_motion.h"

#include <algorithm>

namespace epafi {

namespace {

Vec3 spin_of(const World& world, Slot s) { return world.rotates() ? world.angular_velocity[s] : Vec3(Vec3::Zero()); }

bool moves_by_itself(const World& world, Slot s) {
  return !world.is_movable(s) && !(world.velocity[s].isZero(0.0) && spin_of(world, s).isZero(0.0));
}

}  // namespace

void DrivenMotion::look(const World& world) {
  linear_.clear();
  angular_.clear();
  const auto note = [&](Slot s, const Vec3& linear, const Vec3& angular) {
    if (linear.isZero(0.0) && angular.isZero(0.0)) return;
    if (linear_.empty()) {
      linear_.assign(world.size(), Vec3::Zero());
      angular_.assign(world.rotates() ? world.size() : 0, Vec3::Zero());
    }
    linear_[s] = linear;
    if (world.rotates()) angular_[s] = angular;
  };
  for (std::size_t k = 0; k < body_.size(); ++k)
    if (const Slot s = world.slot_of(body_[k]); s != no_slot)
      note(s, world.velocity[s] - velocity_[k], spin_of(world, s) - spin_[k]);
  for (Slot s = 0; s < world.size(); ++s)  // those that stood still
    if (moves_by_itself(world, s) && !std::binary_search(body_.begin(), body_.end(), world.id[s]))
      note(s, world.velocity[s], spin_of(world, s));
}

void DrivenMotion::remember(const World& world) {
  body_.clear();
  velocity_.clear();
  spin_.clear();
  for (Slot s = 0; s < world.size(); ++s)
    if (moves_by_itself(world, s)) body_.push_back(world.id[s]);
  std::sort(body_.begin(), body_.end());
  for (const BodyId body : body_) {
    const Slot s = world.slot_of(body);
    velocity_.push_back(world.velocity[s]);
    spin_.push_back(spin_of(world, s));
  }
}

void DrivenMotion::visit(StateVisitor& visitor) {
  visitor.column("driven/body", body_);
  visitor.column("driven/velocity", velocity_);
  visitor.column("driven/spin", spin_);
}

}  // namespace epafi
