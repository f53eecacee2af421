/// @file strip_influence.h  Displacement under a strip that carries a semi-elliptic pressure along x, p sqrt(1 -
/// x^2/a^2), uniform over its width: in closed form by elliptic integrals across the strip, from a table.
#pragma once
#include <span>

namespace epafi {

/// Influence of the strip from its centre line to a line at t half-lengths beside it; odd in t, error below 1e-6.
struct StripInfluence {
  /// G(t) = int_0^t F, F(t) = int_-1^1 sqrt(1 - s^2) / sqrt(s^2 + t^2) ds = 2 D(k') / sqrt(1 + t^2), k' = t / sqrt(1 +
  /// t^2). Displacement at (0, d) from the strip's middle: (p a / (pi E*)) (G((d + w/2)/a) - G((d - w/2)/a)).
  double displacement;
  /// S(t) = 2 k' K(k'), from F_xx = -2 int_0^pi/2 sin^2 / (sin^2 + t^2)^(3/2). Curvature along the track there:
  /// (p / (pi E* a)) (S((d + w/2)/a) - S((d - w/2)/a)), as of a hollow.
  double bend;
};
StripInfluence strip_influence(double t);

/// One strip of a patch: its middle, the gap there, peak pressure, half-length and width.
struct PressedStrip {
  double y, gap, p, a, width;
};
/// Residual gap under these pressures: root mean square of displacement + gap - approach over the strips, weighted by
/// pressure, relative to the approach. 0 for Hertz; an error measure for virtual penetration.
double misfit_of(std::span<const PressedStrip> strips, double approach, double modulus);
/// Error of the peak pressure, relative, where a law of virtual penetration leaves so much of the gap: 430 random pairs
/// of profiles against boundary elements, three laws.
inline double error_of_gap_left(double misfit) { return 0.003 + 5.0 * misfit; }

}  // namespace epafi
