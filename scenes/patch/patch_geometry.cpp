#include <fmt/format.h>

#include "scenes/patch/evaluate_patch.h"

namespace epafi {

std::string patch_geometry_csv(const PatchCase& c) {
  std::string out =
      "lateral_shift,roll,left_y_wheel,left_y_rail,left_angle,left_rolling_radius,right_y_wheel,right_y_rail,right_"
      "angle,"
      "right_rolling_radius,rolling_radius_difference,equivalent_conicity\n";
  if (!c.profiles) return out;
  const ProfileCase& p = *c.profiles;
  for (int k = 0; k <= 8; ++k) {
    WheelsetPosition position;
    position.lateral_shift = 1e-3 * k, position.yaw = p.position.yaw;
    const WheelsetGeometry g = stand_on_rails(p.wheel, p.rail, p.track, position);
    out += fmt::format("{:.6g},{:.6g}", position.lateral_shift, g.position.roll);
    for (const ContactRegion* r : {&g.left, &g.right})
      out += fmt::format(",{:.6g},{:.6g},{:.6g},{:.8g}", r->y_wheel, r->y_rail, r->angle, r->rolling_radius);
    out += fmt::format(",{:.6g},", g.rolling_radius_difference());
    out +=
        k > 0 ? fmt::format("{:.5g}\n", equivalent_conicity(p.wheel, p.rail, p.track, position.lateral_shift)) : "\n";
  }
  return out;
}

}  // namespace epafi
