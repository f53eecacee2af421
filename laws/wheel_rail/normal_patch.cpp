#include "laws/wheel_rail/normal_patch.h"

#include <cmath>
#include <numbers>

namespace epafi {

NormalPatch patch_of_hertz(const HertzContact& c) {
  NormalPatch p;
  p.ellipse = c.ellipse;
  p.normal_force = c.normal_force;
  p.approach = c.approach;
  p.max_pressure = c.max_pressure;
  p.area = std::numbers::pi * c.ellipse.a * c.ellipse.b;
  return p;
}

void set_equivalent_ellipse(NormalPatch& p) {
  double s = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, syy = 0.0;
  for (std::size_t k = 0; k < p.pressure.size(); ++k) {
    const double x = p.grid.x(k % p.grid.nx), y = p.grid.y(k / p.grid.nx), w = p.pressure[k];
    s += w;
    sx += w * x;
    sy += w * y;
    sxx += w * x * x;
    syy += w * y * y;
  }
  p.is_ellipse = false;
  if (!(s > 0.0)) return;
  p.normal_force = s * p.grid.cell();
  p.centre_x = sx / s;
  p.centre_y = sy / s;
  // a cell of uniform pressure adds dx^2 / 12 to the second moment
  const double xx = sxx / s - p.centre_x * p.centre_x + p.grid.dx * p.grid.dx / 12.0;
  const double yy = syy / s - p.centre_y * p.centre_y + p.grid.dy * p.grid.dy / 12.0;
  p.ellipse = {std::sqrt(5.0 * xx), std::sqrt(5.0 * yy)};
}

}  // namespace epafi
