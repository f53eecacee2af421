/// @file gap_operator.h  Gaps between deformable surfaces as a function of nodal positions, with derivatives: the seam
/// between surface search (node-to-surface, surface-to-surface) and the methods that enforce contact on finite
/// elements.
#pragma once
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "engine/state/types.h"

namespace epafi {

/// g_c(X) of every contact candidate c, its normal, and dg_c/dX as rows of (node, weight): dg_c = sum weight * normal .
/// dx_node.
struct GapRows {
  std::vector<double> gap;                 ///< [m]
  std::vector<Vec3> normal;                ///< unit, from the first surface to the second
  std::vector<std::uint32_t> begin, node;  ///< CSR over candidates
  std::vector<double> weight;
  std::vector<double> area;  ///< of the second surface that the candidate stands for [m^2]; empty: unknown
  void clear() {
    gap.clear();
    normal.clear();
    begin.assign(1, 0);
    node.clear();
    weight.clear();
    area.clear();
  }
};

/// Candidates are the nodes of the second surface, or integration points of its triangles.
enum class GapMethod { node_to_surface, surface_to_surface };

class GapOperator {
 public:
  virtual ~GapOperator() = default;
  virtual void evaluate(std::span<const Vec3> positions, GapRows& out) const = 0;
};

}  // namespace epafi
