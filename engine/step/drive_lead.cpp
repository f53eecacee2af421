#include "engine/step/drive_lead.h"

#include <algorithm>
#include <string>

namespace epafi {

void DriveLead::before_step(World& world, double dt, std::vector<BodyId>&) {
  const Slot s = world.slot_of(body_);
  if (s == no_slot) return;
  const State before = state_;
  state_.middle = world.velocity[s];
  state_.change = state_.middle - before.middle;
  // a velocity that jumps, as at the start of a motion, has no acceleration
  constexpr double jump = 0.9;
  const double largest = std::max(state_.change.norm(), before.change.norm());
  const bool jumps = (state_.change - before.change).norm() > jump * largest;
  const Vec3 rise = jumps ? Vec3(Vec3::Zero()) : Vec3(0.5 * state_.change);
  state_.end = state_.middle + rise;
  world.velocity[s] = state_.end;
  world.position[s] -= dt * rise;
  // the force of the last detection acts with the velocity of that time, over half a step on both sides
  if (world.columns().held_force) ledger_.add_work(0.5 * dt * world.force[s].dot(state_.end - before.end));
}

void DriveLead::visit(StateVisitor& visitor) {
  const std::string name = "drive/" + std::to_string(static_cast<std::uint32_t>(body_));
  if (visitor.has(name + "/middle")) visitor.value(name + "/middle", state_.middle);
  if (visitor.has(name + "/change")) visitor.value(name + "/change", state_.change);
  if (visitor.has(name + "/end")) visitor.value(name + "/end", state_.end);
}

}  // namespace epafi
