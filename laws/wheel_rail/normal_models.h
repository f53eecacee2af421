/// @file normal_models.h  The list of normal models: name, what it is, and the function that finds the patches of a
/// case.
#pragma once
#include <string>
#include <vector>

#include "engine/contact_region.h"
#include "engine/registry.h"
#include "laws/wheel_rail/elastic_pair.h"
#include "laws/wheel_rail/half_space/normal.h"
#include "laws/wheel_rail/normal_patch.h"

namespace epafi {

struct NormalInput {
  const GapSource& source;
  const std::vector<ContactRegion>& regions;  ///< the deepest first
  ElasticPair elastic;
  NormalTarget target;        ///< force along the normal, or approach
  double dx = 0.0, dy = 0.0;  ///< cells [m]; 0: the shorter axis has 32
};

struct RegionPatch {
  std::size_t region = 0;  ///< index of the region it belongs to
  NormalPatch patch;
};

struct NormalModel {
  Entry entry;
  std::vector<RegionPatch> (*solve)(const NormalInput&);
};

const std::vector<NormalModel>& all_normal_models();

}  // namespace epafi
