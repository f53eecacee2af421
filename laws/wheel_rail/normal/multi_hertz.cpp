#include <algorithm>
#include <cmath>

#include "laws/wheel_rail/normal/models.h"

namespace epafi {

std::vector<RegionPatch> solve_multi_hertz(const NormalInput& in) {
  const double E = in.elastic.effective_modulus();
  std::vector<std::size_t> closed;
  for (std::size_t k = 0; k < in.regions.size(); ++k)
    if (in.regions[k].curvature_x > 0.0 && in.regions[k].curvature_y > 0.0) closed.push_back(k);
  if (closed.empty()) return solve_hertz(in);
  // approaches are along the normal of the first region; since the wheel moves along z, the others follow by the ratio
  // of the cosines
  const auto closes = [&](std::size_t k) {
    return k == 0 ? 1.0 : std::cos(in.regions[k].angle) / std::cos(in.regions[0].angle);
  };
  const auto contact = [&](std::size_t k, double approach) {
    const ContactRegion& r = in.regions[k];
    return hertz_of_approach(0.5 * r.curvature_x, 0.5 * r.curvature_y, E, approach * closes(k) - r.offset);
  };
  double approach = in.target.value;
  if (in.target.by_force) {
    // the force grows with the approach; the first region alone bounds it from above
    const ContactRegion& r = in.regions[closed[0]];
    double low = 0.0,
           high = (r.offset + hertz_of_force(0.5 * r.curvature_x, 0.5 * r.curvature_y, E, in.target.value).approach) /
                  closes(closed[0]);
    for (int n = 0; n < 80 && high - low > 1e-15 * high; ++n) {
      approach = 0.5 * (low + high);
      double force = 0.0;
      for (const std::size_t k : closed) force += contact(k, approach).normal_force;
      (force < in.target.value ? low : high) = approach;
    }
  }
  std::vector<RegionPatch> out;
  for (const std::size_t k : closed) {
    if (in.regions[k].offset >= approach * closes(k)) continue;
    RegionPatch p{k, patch_of_hertz(contact(k, approach))};
    p.patch.approach = approach;
    check_hertz_range(in.regions[k], p.patch, p.patch.reasons);
    const Ellipse& e = p.patch.ellipse;
    p.patch.error_estimate = std::min(1.0, distortion(in.regions[k], e.b) + 0.06 * askew(in.regions[k], e.b, e.a));
    for (const RegionPatch& other : out) {
      const double apart = std::abs(in.regions[k].point.y() - in.regions[other.region].point.y());
      if (apart < p.patch.ellipse.b + other.patch.ellipse.b)
        p.patch.reasons.push_back("two ellipses overlap: the regions are one patch");
      else if (apart - p.patch.ellipse.b - other.patch.ellipse.b < in.influence.none)
        p.patch.reasons.push_back(
            "two regions near enough to press on each other, which ellipses of their own leave out");
    }
    out.push_back(std::move(p));
  }
  return out;
}

}  // namespace epafi
