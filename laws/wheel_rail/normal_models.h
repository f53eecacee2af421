/// @file normal_models.h  The list of normal models: name, what it is, and the function that finds the patches of a
/// case.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/railway/contact_region.h"
#include "engine/units/registry.h"
#include "laws/wheel_rail/elastic_pair.h"
#include "laws/wheel_rail/half_space/normal.h"
#include "laws/wheel_rail/normal_patch.h"

namespace epafi {

/// Strips of the last solution of a patch, as start values: half-lengths over those of the undeformed overlap.
struct StripStart {
  static constexpr std::size_t most = 64;
  std::uint64_t count = 0;  ///< 0: nothing is known
  std::array<double, most> share{};
  /// Share at this part of the way from the first strip's edge to the last one's, in [0, 1].
  double at(double part) const {
    const double x = part * static_cast<double>(count) - 0.5, last = static_cast<double>(count - 1);
    const double inside = x < 0.0 ? 0.0 : x > last ? last : x;
    const auto k = static_cast<std::uint64_t>(inside);
    const double f = inside - static_cast<double>(k);
    return k + 1 < count ? (1.0 - f) * share[k] + f * share[k + 1] : share[k];
  }
};

struct NormalInput {
  const GapSource& source;
  const std::vector<ContactRegion>& regions;  ///< the deepest first
  ElasticPair elastic;
  NormalTarget target;          ///< force along the normal, or approach
  double dx = 0.0, dy = 0.0;    ///< cells [m]; 0: the shorter axis has 32
  double approach = 0.0;        ///< an estimate of it where one is known [m], 0: none
  int strips = 0;               ///< across the patch, for models of strips; 0: by their own rule
  int along = 44;               ///< cells of a strip
  bool stresses = false;        ///< finite elements keep those inside the body
  StripStart* start = nullptr;  ///< strips to start from; left as they ended
  double settle = 1e-3;         ///< change of the strips' lengths, over the longest, at which they are settled
  InfluenceRange influence{};   ///< between regions apart, for models of the whole gap
  double penalty = 100.0;       ///< stiffness of a node of finite elements over E* a, where contact is by penalty
};

struct RegionPatch {
  std::size_t region = 0;  ///< index of the region it belongs to
  NormalPatch patch;
};

struct NormalModel {
  Entry entry;
  std::vector<RegionPatch> (*solve)(const NormalInput&);
  bool whole_gap = false;  ///< takes the gap over the patch, not the curvatures at the rigid contact point
  bool strips = false;     ///< takes both: its patch lies where the overlap does
};

/// Reference position of a patch: mean position and angle of the undeformed overlap at this approach, weighted by the
/// squared vertical depth over the area (as printed by CONTACT; for two regions it lies between them).
struct PatchPlace {
  double y = 0.0, angle = 0.0;  ///< in the region's tangent plane [m]; track axes [rad]
};
/// Approach of a case by a few strips (semi_hertz.cpp): to start finer models from [m].
double estimate_approach(const NormalInput& in);
PatchPlace place_of_patch(const GapSource& source, const ContactRegion& region, double approach);

const std::vector<NormalModel>& all_normal_models();

}  // namespace epafi
