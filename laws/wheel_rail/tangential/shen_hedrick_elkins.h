/// @file shen_hedrick_elkins.h  Kalker's linear force bent under Coulomb's bound (Shen, Hedrick, Elkins 1983):
/// F = mu N (rho - rho^2/3 + rho^3/27), rho = |F_linear| / (mu N) < 3. Within 0.04 mu N for pure creepage; useless for
/// large spin, where it stays at mu N while the true force falls (0.85 mu N off): flagged.
#pragma once
#include "laws/wheel_rail/tangential/kalker_linear.h"

namespace epafi {

/// Force over Coulomb's bound if the linear theory gives rho times the bound.
inline double cubic_saturation(double rho) { return rho >= 3.0 ? 1.0 : rho * (1.0 + rho * (-1.0 / 3.0 + rho / 27.0)); }

inline PatchForce shen_hedrick_elkins(const RollingCase& c) {
  PatchForce f = kalker_linear(c);
  const double size = std::hypot(f.fx, f.fy), bound = c.bound();
  if (!(size > 0.0)) return f;
  const double factor = bound > 0.0 ? bound * cubic_saturation(size / bound) / size : 0.0;
  return {f.fx * factor, f.fy * factor, f.mz * factor};
}

}  // namespace epafi
