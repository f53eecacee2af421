#include "laws/wheel_rail/tangential/beside_plane.h"

#include <algorithm>
#include <cmath>

#include "laws/wheel_rail/tangential/fastsim.h"
#include "laws/wheel_rail/tangential/kalker_table.h"

namespace epafi {
namespace {

StripPatch strips_beside_plane(const TangentialInput& in) {
  constexpr std::uint32_t cells = 32;
  if (in.patch.is_ellipse)
    return strips_of_ellipse(in.patch.ellipse, in.patch.normal_force, cells, cells, Bound::parabolic);
  return strips_of_field(in.patch.grid, in.patch.pressure, Bound::parabolic);
}

}  // namespace

double SlipBesidePlane::at(double y) const {
  if (value.empty()) return 0.0;
  const double last = static_cast<double>(value.size() - 1), place = std::clamp((y - first) / step, 0.0, last);
  const auto k = static_cast<std::size_t>(place);
  const double next = value[std::min(k + 1, value.size() - 1)], share = place - static_cast<double>(k);
  return value[k] + share * (next - value[k]);
}

double force_beside_plane(const TangentialInput& in, const SlipBesidePlane& slip) {
  const double bound = in.friction * in.patch.normal_force;
  if (!(bound > 0.0) || slip.value.empty()) return 0.0;
  const NormalPatch& p = in.patch;
  const RollingCase c{p.ellipse, p.normal_force, in.elastic, in.friction,
                      creepage_at(in.creepage, p.centre_x, p.centre_y)};
  const KalkerCoefficients k = kalker_coefficients(p.ellipse.a / p.ellipse.b, in.elastic.poissons_ratio);
  const Flexibility L = kalker_flexibility(c, k, FlexibilityRule::blended);
  StripPatch strips = strips_beside_plane(in);
  const PatchForce plane = fastsim(strips, L, in.friction, creepage_of_cells(in), false).force;
  for (Strip& s : strips.strips) s.slip = slip.at(s.y);
  const PatchForce surface = fastsim(strips, L, in.friction, creepage_of_cells(in), false).force;
  return std::hypot(surface.fx - plane.fx, surface.fy - plane.fy) / bound;
}

}  // namespace epafi
