/// @file gap_at.h  Gap of a region between the samples of its profile, or of its parabola.
#pragma once
#include <algorithm>
#include <vector>

#include "engine/railway/contact_region.h"

namespace epafi {

/// Gap and curvature for a strip at one lateral position.
struct GapAt {
  double gap;        ///< [m]
  double curvature;  ///< along the track [1/m]
  double centre;     ///< x where the gap is smallest [m]
};

/// At y [m] of the region's tangent plane; beyond the profile's ends its last samples.
inline GapAt gap_at(const ContactRegion& r, double y) {
  const GapProfile& g = r.profile;
  if (g.size() == 0) return {0.5 * r.curvature_y * y * y, r.curvature_x, 0.0};
  const double x = std::clamp((y - g.start) / g.step, 0.0, static_cast<double>(g.size()) - 1.000001);
  const auto k = static_cast<std::size_t>(x);
  const double f = x - static_cast<double>(k);
  const auto mix = [&](const std::vector<double>& v) { return (1.0 - f) * v[k] + f * v[k + 1]; };
  // the gap bends sharply (100 /m on a flange): a cubic through four samples, for a chord would cost 1e-6 m
  double h = mix(g.gap);
  if (k > 0 && k + 2 < g.size())
    h = 0.5 * (2.0 * g.gap[k] + f * (g.gap[k + 1] - g.gap[k - 1] +
                                     f * (2.0 * g.gap[k - 1] - 5.0 * g.gap[k] + 4.0 * g.gap[k + 1] - g.gap[k + 2] +
                                          f * (3.0 * (g.gap[k] - g.gap[k + 1]) + g.gap[k + 2] - g.gap[k - 1]))));
  return {h, mix(g.curvature_x), mix(g.centre_x)};
}

}  // namespace epafi
