/// @file strip_influence.h  Displacement under a strip that carries a semi-elliptic pressure along x, p sqrt(1 -
/// x^2/a^2), uniform over its width: in closed form by elliptic integrals across the strip, from a table.
#pragma once

namespace epafi {

/// G(t) = int_0^t F, F(t) = int_-1^1 sqrt(1 - s^2) / sqrt(s^2 + t^2) ds = 2 D(k') / sqrt(1 + t^2), k' = t / sqrt(1 +
/// t^2). Odd. Displacement at (0, d) from the strip's middle: (p a / (pi E*)) (G((d + w/2)/a) - G((d - w/2)/a)). Error
/// below 1e-6.
double strip_integral(double t);

}  // namespace epafi
