/// @file narrow.h  `epafi narrow CORPUS`: signed distance, normal and closest points of listed convex pairs, and their
/// cost.
#pragma once
#include <string>

namespace epafi {

struct NarrowOptions {
  std::string corpus;           ///< file in the CXP1 format
  std::string method = "auto";  ///< auto, sat, gjk-epa
  std::string out;              ///< file; empty: stdout
  bool json = false;
};

/// A row per pair (pair,status,distance,n,pa,pb,ns), then `# mean ns cold ..., warm ...`. cold: nothing is known of the
/// pair; warm: its pose has changed by 1e-3 of its size (shift and turn) since the last query. CPU time of one thread,
/// views of the hulls made, rows not written. A body that is no convex polyhedron: status refused, no numbers.
int command_narrow(const NarrowOptions& options);

}  // namespace epafi
