/// @file restitution.h  The damping that gives exactly the restitution of a scene, computed once per material pair. The
/// contact never pulls: it ends when the force is zero, while the bodies still overlap. The textbook formula zeta = -ln
/// e / sqrt(pi^2 + ln^2 e) ends at zero overlap instead, and gives 0.55 for 0.5 (Schwager and Poeschel 2007).
#pragma once

namespace epafi {

/// Smallest restitution the dampers are set for [-]. e = 0 needs infinite damping, and e = 0.01 (damping ratio 4.7)
/// already leaves 1e-4 of the energy; below, a shorter time step would buy nothing.
inline constexpr double minimum_restitution = 0.01;

/// e of a linear spring and dashpot of damping ratio zeta >= 0 that may not pull (Schwager and Poeschel 2007):
/// e = exp(-2 zeta acos(zeta) / sqrt(1 - zeta^2)), with acosh beyond 1. In (0, 1], falling.
double restitution_of(double damping_ratio);

/// The inverse: zeta = c / (2 sqrt(m* k)) for e in [0, 1]; values below minimum_restitution act as that.
/// Hertz with Tsuji damping obeys the same relation with alpha = sqrt(5) zeta, whatever the speed, mass and modulus:
/// with y = delta^(5/4) as the variable of energy, its first integral is that of the linear law (Antypov and Elliott
/// 2011).
double damping_ratio_for(double restitution);

/// X = chi v0 of the Hunt and Crossley force K delta^n (1 + chi delta_dot), from (1 + X)/(1 - e X) = exp(X (1 + e))
/// (Gonthier et al. 2004; Zhang and Sharf 2009): exact for every K, n and mass. e in [0, 1], floor as above.
double hunt_crossley_factor(double restitution);

/// The inverse: e in (0, 1] that a factor X >= 0 returns, by the same relation.
double hunt_crossley_restitution(double factor);

}  // namespace epafi
