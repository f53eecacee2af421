#include <cmath>

#include "laws/wheel_rail/tangential/strips.h"

namespace epafi {

StripPatch strips_of_field(const PatchGrid& grid, const std::vector<double>& pressure, Bound bound) {
  StripPatch patch;
  double p1 = 0.0, p2 = 0.0;
  for (const double p : pressure) {
    p1 += p;
    p2 += p * p;
  }
  // p0^2 (1 - r^2) of Hertz times 4 / (3 p0) is the parabola of the same force
  const double square = bound == Bound::parabolic && p2 > 0.0 ? p1 / p2 : 0.0;
  for (std::size_t j = 0; j < grid.ny; ++j) {
    for (std::size_t i = grid.nx; i-- > 0;) {
      if (!(pressure[j * grid.nx + i] > 0.0)) continue;
      Strip s{grid.y(j), grid.dy, grid.x(i) + 0.5 * grid.dx, 0.0, static_cast<std::uint32_t>(patch.pressure.size()), 0};
      for (;; --i) {
        const double p = pressure[j * grid.nx + i];
        if (!(p > 0.0)) break;
        patch.pressure.push_back(square > 0.0 ? square * p * p : p);
        ++s.count;
        if (i == 0) break;
      }
      s.trailing = s.leading - s.count * grid.dx;
      patch.strips.push_back(s);
      if (i == 0) break;
    }
  }
  return patch;
}

}  // namespace epafi
