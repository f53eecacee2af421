#include <fmt/format.h>

#include <cmath>

#include "scenes/patch/evaluate_patch.h"

namespace epafi {

namespace {
/// Columns roll to rolling_radius_difference; empty where the wheelset does not touch both rails.
std::string contact_cells(const WheelsetGeometry& g) {
  if (!g.stands) return ",,,,,,,,,";
  std::string out = fmt::format("{:.6g}", g.position.roll);
  for (const ContactRegion* r : {&g.left, &g.right})
    out += fmt::format(",{:.6g},{:.6g},{:.6g},{:.8g}", r->y_wheel, r->y_rail, r->angle, r->rolling_radius);
  return out + fmt::format(",{:.6g}", g.rolling_radius_difference());
}
}  // namespace

PatchGeometry patch_geometry(const PatchCase& c) {
  PatchGeometry geometry;
  std::string& out = geometry.csv;
  out =
      "lateral_shift,roll,left_y_wheel,left_y_rail,left_angle,left_rolling_radius,right_y_wheel,right_y_rail,right_"
      "angle,"
      "right_rolling_radius,rolling_radius_difference,equivalent_conicity\n";
  if (!c.profiles) return geometry;
  const ProfileCase& p = *c.profiles;
  for (int k = 0; k <= 8; ++k) {
    WheelsetPosition position;
    position.lateral_shift = 1e-3 * k;
    position.yaw = p.position.yaw;
    const WheelsetGeometry g = stand_on_rails(p.wheel, p.rail, p.track, position);
    geometry.standing += g.stands ? 1 : 0;
    geometry.shifts += 1;
    out += fmt::format("{:.6g},", position.lateral_shift) + contact_cells(g) + ",";
    const double conicity =
        k > 0 ? equivalent_conicity(p.wheel, p.rail, p.track, position.lateral_shift) : std::nan("");
    out += std::isfinite(conicity) ? fmt::format("{:.5g}\n", conicity) : "\n";
  }
  return geometry;
}

}  // namespace epafi
