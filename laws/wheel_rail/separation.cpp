#include "laws/wheel_rail/separation.h"

#include <algorithm>
#include <cmath>

namespace epafi {

std::vector<OverlapRange> overlaps_of(const GapProfile& g, double approach) {
  const auto crossing = [&](std::size_t in,
                            std::size_t out) {  // by linear interpolation: ends must not jump as the approach grows
    const double rise = g.gap[out] - g.gap[in];
    return g.y(in) + (g.y(out) - g.y(in)) * (rise > 0.0 ? std::min(1.0, (approach - g.gap[in]) / rise) : 1.0);
  };
  std::vector<OverlapRange> out;
  bool inside = false;
  for (std::size_t k = 0; k < g.size(); ++k) {
    const bool now = g.gap[k] < approach;
    if (now && !inside) out.push_back({k > 0 ? crossing(k, k - 1) : g.y(k), 0.0});
    if (now) out.back().high = k + 1 < g.size() ? crossing(k, k + 1) : g.y(k);
    inside = now;
  }
  return out;
}

Separation::Separation(std::span<const OverlapRange> overlaps, const InfluenceRange& range) {
  for (std::size_t k = 1; k < overlaps.size(); ++k) {
    const double apart = overlaps[k].low - overlaps[k - 1].high;
    if (!(apart > range.full) || !std::isfinite(range.none)) continue;
    border_.push_back(0.5 * (overlaps[k].low + overlaps[k - 1].high));
    const double left = (range.none - apart) / (range.none - range.full);
    share_.push_back(left > 0.0 ? std::pow(left, 0.8) : 0.0);
  }
}

std::size_t Separation::group(double y) const {
  return static_cast<std::size_t>(std::lower_bound(border_.begin(), border_.end(), y) - border_.begin());
}

double Separation::share(std::size_t a, std::size_t b) const {
  double s = 1.0;
  for (std::size_t k = std::min(a, b); k < std::max(a, b); ++k) s *= share_[k];
  return s;
}

Separation Separation::shifted(double by) const {
  Separation out = *this;
  for (double& y : out.border_) y -= by;
  return out;
}

}  // namespace epafi
