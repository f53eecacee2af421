#include "laws/wheel_rail/tangential/fastsim.h"

#include <cmath>
#include <numbers>

namespace epafi {
namespace {

using std::numbers::pi;

/// Linear force over the bound: 0 is full stick, above about 3 full slip.
double saturation(const RollingCase& c, const KalkerCoefficients& k) {
  const double ab = c.ellipse.a * c.ellipse.b, Gab = c.elastic.shear_modulus * ab;
  const Creepage& s = c.creepage;
  return Gab * std::hypot(k.c11 * s.longitudinal, k.c22 * s.lateral, std::sqrt(ab) * k.c23 * s.spin) / c.bound();
}

}  // namespace

Flexibility kalker_flexibility(const RollingCase& c, const KalkerCoefficients& k, FlexibilityRule rule) {
  const double a = c.ellipse.a, b = c.ellipse.b, G = c.elastic.shear_modulus;
  const Flexibility three{8.0 * a / (3.0 * k.c11 * G), 8.0 * a / (3.0 * k.c22 * G),
                          pi * a * std::sqrt(a / b) / (4.0 * k.c23 * G)};
  if (rule == FlexibilityRule::three) return three;
  // one flexibility L for all creepages, with the same linear force: spin counts as the lateral creepage 3/32 pi a phi.
  // (The mean weighted by creepages, Kalker 1990, is 0.18 mu N off for lateral creepage with spin; this one 0.03 mu N.)
  const double x = std::abs(c.creepage.longitudinal), y = std::abs(c.creepage.lateral);
  const double s = 3.0 / 32.0 * pi * a * std::abs(c.creepage.spin);
  if (!(x + y + s > 0.0)) return three;
  const double one = std::hypot(x, y + s) / std::hypot(x / three.longitudinal, y / three.lateral + s / three.spin);
  if (rule == FlexibilityRule::one) return {one, one, one};
  // without friction there is no stick and the saturation is infinite
  constexpr double all_slides = 1e3;
  const double rho = saturation(c, k), r = rho * rho * rho * rho, share = rho < all_slides ? r / (1.0 + r) : 1.0;
  const auto mix = [&](double own) { return 1.0 / ((1.0 - share) / own + share / one); };
  return {mix(three.longitudinal), mix(three.lateral), mix(three.spin)};
}

// Kalker's own rule: slip at the cell's centre over a whole cell, from 0 before the first. It is of first order; on the
// usual 40 cells it lies 0.012 mu N above its limit for pure creepage, towards the half-space solution.
StripSolution fastsim(const StripPatch& patch, const Flexibility& L, double friction, const Creepage& s, bool store) {
  StripSolution out;
  if (store) {
    for (auto* column : {&out.traction_x, &out.traction_y, &out.slip_x, &out.slip_y})
      column->assign(patch.cells(), 0.0);
    out.sticks.assign(patch.cells(), 1);
  }
  const double gx0 = s.longitudinal / L.longitudinal, gy0 = s.lateral / L.lateral, gs = s.spin / L.spin;
  double stick = 0.0, area = 0.0;
  for (const Strip& strip : patch.strips) {
    const double h = strip.cell(), gx = gx0 - gs * strip.y + strip.slip / L.longitudinal, dA = h * strip.width;
    double qx = 0.0, qy = 0.0, fx = 0.0, fy = 0.0, mz = 0.0;
    std::uint32_t sticking = 0;
    for (std::uint32_t k = 0; k < strip.count; ++k) {
      const double x = strip.x(k), gy = gy0 + gs * x;
      const double tx = qx - gx * h, ty = qy - gy * h, bound = friction * patch.pressure[strip.first + k];
      const double size2 = tx * tx + ty * ty;
      const bool slides = size2 > bound * bound;
      const double scale = slides ? bound / std::sqrt(size2) : 1.0;
      qx = tx * scale;
      qy = ty * scale;
      sticking += !slides;
      if (slides) {
        const double wx = (qx - tx) / h * L.longitudinal, wy = (qy - ty) / h * L.lateral;
        out.frictional_power += (std::abs(qx * wx) + std::abs(qy * wy)) * dA;
        if (store) {
          out.slip_x[strip.first + k] = wx;
          out.slip_y[strip.first + k] = wy;
        }
        if (store) out.sticks[strip.first + k] = 0;
      }
      if (store) {
        out.traction_x[strip.first + k] = qx;
        out.traction_y[strip.first + k] = qy;
      }
      fx += qx;
      fy += qy;
      mz += x * qy - strip.y * qx;
    }
    out.force.fx += fx * dA;
    out.force.fy += fy * dA;
    out.force.mz += mz * dA;
    stick += sticking * dA;
    area += strip.count * dA;
  }
  out.stick_share = area > 0.0 ? stick / area : 0.0;
  return out;
}

}  // namespace epafi
