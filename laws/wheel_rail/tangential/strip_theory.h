/// @file strip_theory.h  Every strip of the patch as a plane rolling contact (Haines and Ollerton 1963, Kalker 1967):
/// exact for slender patches across the track (a << b), up to 25 % off on a circle and 40 % with spin. FaStrip
/// (Sichani, Enblom, Berg 2016) corrects it: creepages scaled so that the linear force is Kalker's, slip direction
/// marched as in FASTSIM.
#pragma once
#include "laws/wheel_rail/tangential/fastsim.h"

namespace epafi {

/// Traction of one strip of half-width a(y): q = kappa sqrt(a^2 - x^2) - lambda sqrt(d^2 - (x - shift)^2), in units of
/// the bound's mu p0 / a0; stick for x > shift - d, d = a(y) - shift.
struct StripStick {
  double shift;  ///< a - d [m]; a(y) where all slides
  double kappa_x, kappa_y, lambda_x, lambda_y;
  bool all_slides;
};

/// Plane solution: kappa = lambda for longitudinal creepage, kappa_y - lambda_y = psi for spin, |kappa| = 1 in the slip
/// zone. xi, eta: creepage as shift [m]; psi: spin as share of the bound's slope [-].
StripStick strip_stick(double half_width, double xi, double eta, double psi);

/// The plane problem by strips, its own stiffness.
StripSolution strip_theory(const StripPatch& patch, const RollingCase& c, bool store);

/// FaStrip type.
StripSolution fastrip(const StripPatch& patch, const RollingCase& c, const KalkerCoefficients& k, bool store);

}  // namespace epafi
