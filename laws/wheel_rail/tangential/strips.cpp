#include "laws/wheel_rail/tangential/strips.h"

#include <cmath>

#include "engine/units/error.h"

namespace epafi {

StripPatch strips_of_ellipse(Ellipse e, double normal_force, std::uint32_t along, std::uint32_t across, Bound bound) {
  EPAFI_REQUIRE(along > 0 && across > 0 && e.a > 0.0 && e.b > 0.0, "cells over an ellipse");
  StripPatch patch;
  patch.strips.reserve(across);
  patch.pressure.reserve(std::size_t{along} * across);
  const double width = 2.0 * e.b / across;
  double sum = 0.0;
  for (std::uint32_t j = 0; j < across; ++j) {
    const double y = -e.b + (j + 0.5) * width, rest = 1.0 - y * y / (e.b * e.b), half = e.a * std::sqrt(rest);
    patch.strips.push_back({y, width, half, -half, static_cast<std::uint32_t>(patch.pressure.size()), along});
    for (std::uint32_t k = 0; k < along; ++k) {
      const double t = 1.0 - 2.0 * (k + 0.5) / along, parabola = rest * (1.0 - t * t);
      const double p = bound == Bound::elliptic ? std::sqrt(parabola) : parabola;
      patch.pressure.push_back(p);
      sum += p * half;
    }
  }
  const double scale = normal_force / (sum * 2.0 * width / along);
  for (double& p : patch.pressure) p *= scale;
  return patch;
}

StripPatch strip_of_line(Ellipse box, double normal_force, std::uint32_t along) {
  StripPatch patch{{{0.0, 2.0 * box.b, box.a, -box.a, 0, along}}, {}};
  double sum = 0.0;
  for (std::uint32_t k = 0; k < along; ++k) {
    const double t = 1.0 - 2.0 * (k + 0.5) / along;
    patch.pressure.push_back(std::sqrt(1.0 - t * t));
    sum += patch.pressure.back();
  }
  const double scale = normal_force * along / (4.0 * box.a * box.b * sum);
  for (double& p : patch.pressure) p *= scale;
  return patch;
}

}  // namespace epafi
