/// @file seated_wheel.h  One wheel on its rail in the position under load, with all its contact regions.
#pragma once
#include <string>
#include <vector>

#include "detection/profiles/wheel_rail.h"
#include "laws/wheel_rail/normal_models.h"

namespace epafi {

/// Regions whose profiles reach each other are one (14 mm, 0.3 rad): models of the whole gap solve them together. All
/// others share the load by how deep the wheel stands.
class SeatedWheel {
 public:
  SeatedWheel(const WheelRailPair& on, const ElasticPair& elastic, const InfluenceRange& influence)
      : pair(on), elastic_(elastic), influence_(influence) {}

  /// Finds the regions with the wheel just touching at this place; its height is found.
  void place(const WheelsetPosition& position);
  /// Lowers the wheel to its position under this vertical load, or to this approach of the deepest region.
  void settle(const NormalTarget& target);
  /// Lowers it by `down` from first touch [m].
  void seat(double down);
  /// Patches of all overlapping regions in the present position; `in` holds everything but regions and target.
  std::vector<RegionPatch> solve(const NormalModel& model, NormalInput in);
  /// Radius at the patches, weighted by their forces [m]. It changes steadily where the rigid point jumps.
  double rolling_radius();
  bool apart() const { return seated.size() > 1; }
  /// Approach along the normal over the vertical motion: the wheel moves along z, not along the normal.
  static double steepness(const ContactRegion& r) { return std::cos(r.angle); }

  WheelRailPair pair;
  std::vector<ContactRegion> rigid;   ///< at the rigid contact points, the deepest first
  std::vector<ContactRegion> seated;  ///< of regions that are solved apart, each from the middle of its patch
  double approach = 0.0;              ///< of the deepest region, estimated [m]
  double depth = 0.0;                 ///< displacement of the wheel by the load [m]
  double lowered = 0.0;               ///< present displacement [m]
  /// Strips of the last solutions, as start of the next iteration on the same load.
  std::vector<StripStart> strips = std::vector<StripStart>(1);

 private:
  void settle_deepest(const NormalTarget& target);
  void settle_again(const NormalTarget& target);
  void settle_all(double load);
  bool joins_deepest(const ContactRegion& r);
  void sample(std::size_t k);
  double estimate(const std::vector<ContactRegion>& on, const NormalTarget& target, double value, double known);
  double vertical_force();

  ElasticPair elastic_;
  InfluenceRange influence_;
  double reach_ = 0.0;              ///< of the profiles to both sides [m]
  std::vector<double> sampled_at_;  ///< depth at which the gaps of each seated region were sampled [m]
};

/// Vertical part of a normal force at this angle of the patch.
inline double vertical_part(double force, double angle) { return force * std::cos(angle); }

}  // namespace epafi
