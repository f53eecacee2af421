/// @file held_probe.h  Whether a body that is to be placed would overlap a fixed or driven one.
/// Uses the narrow phase, for every pair of shapes; images in a periodic cell count.
#pragma once
#include <vector>

#include "detection/narrow/narrow_phase.h"

namespace epafi {

class HeldProbe {
 public:
  /// `shapes` must outlive this.
  explicit HeldProbe(const ShapeStore& shapes) : shapes_(shapes), narrow_phase_(shapes, 0.0, false) {}
  /// Copies the fixed and driven bodies of the world, as they stand now, that reach into the box [m].
  void look(const World& world, const Vec3& low, const Vec3& high);
  bool sees_nothing() const { return boxes_.empty(); }
  /// True if the body would overlap one of those by more than rounding.
  bool meets(const Body& body);

 private:
  bool is_near(const World& world, Slot s, const Aabb& box) const;
  void list_pairs(const Aabb& box);

  const ShapeStore& shapes_;
  BatchNarrowPhase narrow_phase_;
  World world_{Columns{.rotation = true, .orientation = true, .free_turn = false, .anisotropy = true, .force = false}};
  std::vector<Aabb> boxes_;  ///< of the bodies seen, which have the slots from 1 on; 0 is the one that asks
  PairList pairs_;
  ContactSet contacts_;
};

}  // namespace epafi
