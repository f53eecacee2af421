/// @file separation.h  Influence of the pressure of one contact region on another region of the same rail. Half-spaces
/// would have full influence; but the surface of a rail turns between tread and gauge corner, and distant patches are
/// solved separately, so the influence fades between two distances (rule and values of CONTACT 25.2, D_COMB and D_SEP
/// in its user guide). S1002 on UIC60 at 5 mm: regions 6.7 mm apart, 39 % of the influence; all of it would raise the
/// peak by 2.4 % and the approach by 3.1 %.
#pragma once
#include <span>
#include <vector>

#include "engine/railway/contact_region.h"

namespace epafi {

/// Distance between the edges of two overlaps, along the rail's surface [m].
struct InfluenceRange {
  double full = 4e-3;  ///< full influence up to this distance [m], >= 0
  double none = 8e-3;  ///< no influence from this distance on [m], >= full; infinite: half-spaces at any distance
};

/// Undeformed surfaces that overlap from y = low to high of the region's tangent plane [m].
struct OverlapRange {
  double low = 0.0, high = 0.0;
};
/// All of a region's profile at this approach, ends on the chord between samples; none without a profile.
std::vector<OverlapRange> overlaps_of(const GapProfile& profile, double approach);

/// Borders between regions, and the share of influence that passes each of them.
class Separation {
 public:
  Separation() = default;
  Separation(std::span<const OverlapRange> overlaps, const InfluenceRange& range);
  bool whole() const { return border_.empty(); }
  std::size_t groups() const { return border_.size() + 1; }
  std::size_t group(double y) const;  ///< number of the region that y belongs to
  /// Influence between two groups: the product over the borders between them, in [0, 1].
  double share(std::size_t a, std::size_t b) const;
  /// The same borders seen from y = `by`.
  Separation shifted(double by) const;

 private:
  std::vector<double> border_, share_;  ///< y [m], ascending; share across it
};

}  // namespace epafi
