/// @file rolling_regions.h  Contact regions of wheels and rails in this step with the undeformed gap around each:
/// result of the search over profiles, input of the laws of rolling contact.
#pragma once
#include <vector>

#include "engine/railway/contact_region.h"

namespace epafi {

/// One contact region. Axes: x along the track, y in the tangent plane to the right, z the normal from wheel to rail.
struct RollingRegion {
  Slot wheelset = no_slot, track = no_slot;
  std::uint32_t name = 0;        ///< wheel (0 left, 1 right) times 16 plus the number of the region from the field side
  bool within = false;           ///< the profile of a deeper region of the same wheel covers it
  bool mirrored = false;         ///< a left wheel: profile and patch are those of its mirror image, y turned round
  double approach = 0.0;         ///< along the normal [m], > 0 overlap
  Vec3 point = Vec3::Zero();     ///< origin of the tangent plane, on the rail, world axes [m]
  Mat3 axes = Mat3::Identity();  ///< columns x, y, z of the patch in world axes
  ContactRegion region;
  const GapSource* source = nullptr;  ///< of this wheel as it stands now
};

struct RollingRegions {
  std::vector<RollingRegion> all;  ///< by wheelset and name
};

}  // namespace epafi
