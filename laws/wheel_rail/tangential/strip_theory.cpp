#include "laws/wheel_rail/tangential/strip_theory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace epafi {
namespace {

using std::numbers::pi;

/// Slope Q = mu p0 / a0 of the bound at the trailing edge; p0 from the cells, so that a line contact is the same.
double bound_slope(const StripPatch& patch, const RollingCase& c) {
  double sum = 0.0;  // sum of a(y)^2 pi/2 over the strips: force per p0/a0
  for (const Strip& s : patch.strips) sum += 0.125 * pi * (s.leading - s.trailing) * (s.leading - s.trailing) * s.width;
  return c.bound() / sum;
}

/// Creepages of the plane problem in its own units.
struct PlaneCreepage {
  double xi, xi_per_y;  ///< shift by longitudinal creepage [m], and by spin per y [-]
  double eta;           ///< shift by lateral creepage [m]
  double psi;           ///< spin [-]
};

/// Q = mu p0 / a0; plane strain: xi = 2 (1 - nu) Q shift / G, antiplane: eta = 2 Q shift / G  (Johnson 1985,
/// section 8.3). The factors scale the plane coefficients pi^2/(4 (1 - nu)), pi^2/4, pi/3 sqrt(a/b) to those given; 1
/// leaves them.
PlaneCreepage plane_creepage(const StripPatch& patch, const RollingCase& c, double fx, double fy, double fs) {
  const double nu = c.elastic.poissons_ratio;
  const double Q = bound_slope(patch, c), per = c.elastic.shear_modulus / (2.0 * Q);
  const Creepage& s = c.creepage;
  return {fx * s.longitudinal * per / (1.0 - nu), -fs * s.spin * per / (1.0 - nu), fy * s.lateral * per,
          fs * s.spin * per};
}

/// Traction over Q in the stick zone.
double stick_traction(double kappa, double lambda, double half, double shift, double x) {
  const double outer = (half - x) * (half + x), d = half - shift, inner = (d - (x - shift)) * (d + (x - shift));
  return kappa * std::sqrt(std::max(0.0, outer)) - lambda * std::sqrt(std::max(0.0, inner));
}

StripSolution solution_of(const StripPatch& patch, bool store) {
  StripSolution out;
  if (!store) return out;
  out.traction_x.assign(patch.cells(), 0.0);
  out.traction_y.assign(patch.cells(), 0.0);
  out.sticks.assign(patch.cells(), 0);
  return out;
}

void store_cell(StripSolution& out, std::size_t cell, double qx, double qy, bool sticks) {
  out.traction_x[cell] = qx;
  out.traction_y[cell] = qy;
  out.sticks[cell] = sticks;
}

StripSolution march(const StripPatch& patch, const RollingCase& c, const PlaneCreepage& plane, const Flexibility* L,
                    bool store) {
  StripSolution out = solution_of(patch, store);
  const double Q = bound_slope(patch, c);
  double stick = 0.0, area = 0.0;
  for (const Strip& strip : patch.strips) {
    const double half = 0.5 * (strip.leading - strip.trailing), middle = 0.5 * (strip.leading + strip.trailing),
                 h = strip.cell();
    const double dA = h * strip.width;
    // lateral slip of spin is eta + phi x, with x from the patch's centre
    const double eta = plane.eta + plane.psi * middle;
    const StripStick z = strip_stick(half, plane.xi + plane.xi_per_y * strip.y, eta, plane.psi);
    const double front = z.all_slides ? half : z.shift - (half - z.shift);
    double rx = 0.0, ry = 0.0;  // traction integrated from the leading edge, for the direction of slip
    for (std::uint32_t k = 0; k < strip.count; ++k) {
      const double x = strip.x(k), from = x - middle, bound = c.friction * patch.pressure[strip.first + k];
      double qx = -Q * stick_traction(z.kappa_x, z.lambda_x, half, z.shift, from);
      double qy = -Q * stick_traction(z.kappa_y, z.lambda_y, half, z.shift, from);
      const bool sticks = from >= front && qx * qx + qy * qy <= bound * bound;
      double tx = qx, ty = qy;
      if (L) {  // slip has the direction of FASTSIM
        tx = rx - (c.creepage.longitudinal / L->longitudinal - c.creepage.spin / L->spin * strip.y) * h;
        ty = ry - (c.creepage.lateral / L->lateral + c.creepage.spin / L->spin * (x + 0.5 * h)) * h;
        const double size = std::hypot(tx, ty), s = size > bound ? bound / size : 1.0;
        rx = tx * s;
        ry = ty * s;
      }
      if (!sticks) {
        if (!L) {
          tx = -z.kappa_x;
          ty = -z.kappa_y;
        }
        const double size = std::hypot(tx, ty);
        qx = size > 0.0 ? bound * tx / size : 0.0;
        qy = size > 0.0 ? bound * ty / size : 0.0;
      } else if (L) {
        rx = qx;
        ry = qy;
      }
      if (store) store_cell(out, strip.first + k, qx, qy, sticks);
      out.force.fx += qx * dA;
      out.force.fy += qy * dA;
      out.force.mz += (x * qy - strip.y * qx) * dA;
      stick += sticks ? dA : 0.0;
      area += dA;
    }
  }
  out.stick_share = area > 0.0 ? stick / area : 0.0;
  return out;
}

}  // namespace

StripStick strip_stick(double half, double xi, double eta, double psi) {
  // kappa_x s = xi, lambda_y s = eta, kappa_y = lambda_y + psi, |kappa| = 1:  (1 - psi^2) s^2 - 2 eta psi s - (xi^2 +
  // eta^2) = 0; its root in the form that stays whole at psi = 1
  const double size = std::hypot(xi, eta), root = eta * eta + (1.0 - psi * psi) * xi * xi;
  if (!(size > 0.0) && std::abs(psi) < 1.0) return {0.0, 0.0, psi, 0.0, 0.0, false};
  const double below = root >= 0.0 ? std::sqrt(root) - eta * psi : 0.0;
  if (!(size > 0.0) || !(below > 0.0) || size * size >= half * below) {
    // full slip: against the rigid slip in the middle of the strip
    return {half, size > 0.0 ? xi / size : 0.0, size > 0.0 ? eta / size : 0.0, 0.0, 0.0, true};
  }
  const double shift = size * size / below;
  return {shift, xi / shift, eta / shift + psi, xi / shift, eta / shift, false};
}

StripSolution strip_theory(const StripPatch& patch, const RollingCase& c, bool store) {
  return march(patch, c, plane_creepage(patch, c, 1.0, 1.0, 1.0), nullptr, store);
}

StripSolution fastrip(const StripPatch& patch, const RollingCase& c, const KalkerCoefficients& k, bool store) {
  const double nu = c.elastic.poissons_ratio;
  const double fx = 4.0 * (1.0 - nu) / (pi * pi) * k.c11, fy = 4.0 / (pi * pi) * k.c22;
  const double fs = 3.0 / pi * std::sqrt(c.ellipse.b / c.ellipse.a) * k.c23;
  const Flexibility L = kalker_flexibility(c, k, FlexibilityRule::blended);
  return march(patch, c, plane_creepage(patch, c, fx, fy, fs), &L, store);
}

}  // namespace epafi
