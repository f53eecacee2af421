/// @file driven_motion.h  How the velocities of driven bodies changed since the last step. What the slip of a contact
/// changes by it is no turning of the geometry (nonsmooth_contact.h, Rolling): taken for one, a box on a shaken table
/// crept.
#pragma once
#include <vector>

#include "engine/state/state_visitor.h"
#include "engine/state/world.h"

namespace epafi {

class DrivenMotion {
 public:
  /// Compares with what was remembered.
  void look(const World& world);
  bool changed() const { return !linear_.empty(); }
  /// Change of the velocity at `arm` from the centre [m/s]; 0 for free and fixed bodies. Requires changed().
  Vec3 change(Slot s, const Vec3& arm) const {
    return angular_.empty() ? linear_[s] : Vec3(linear_[s] + angular_[s].cross(arm));
  }
  void remember(const World& world);
  void visit(StateVisitor& visitor);

 private:
  std::vector<BodyId> body_;            ///< driven, with their motion in the last step
  std::vector<Vec3> velocity_, spin_;   ///< [m/s], [rad/s]
  std::vector<Vec3> linear_, angular_;  ///< by slot: the changes; empty where there is none
};

}  // namespace epafi
