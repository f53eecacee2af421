/// @file elastic_pair.h  Two elastic half-spaces as one: what the patch models of wheel and rail take of the materials.
#pragma once
#include "laws/material.h"

namespace epafi {

/// Combined constants of two half-spaces (Kalker 1990, eq. 1.44): 1/G and nu/G are means over the two bodies.
/// Unlike bodies also couple pressure and traction (Kalker's K); that coupling is left out and flagged by the caller.
struct ElasticPair {
  double shear_modulus = 0.0;   ///< G [Pa], > 0
  double poissons_ratio = 0.0;  ///< nu [-], in (-1, 0.5]
  double coupling = 0.0;        ///< K = G/4 ((1 - 2 nu_a)/G_a - (1 - 2 nu_b)/G_b) [-]; 0 for equal materials

  /// E* = G / (1 - nu) [Pa]
  double effective_modulus() const { return shear_modulus / (1.0 - poissons_ratio); }
};

inline ElasticPair elastic_pair(const Material& a, const Material& b) {
  const double fa = a.is_rigid() ? 0.0 : 1.0 / a.shear_modulus(), fb = b.is_rigid() ? 0.0 : 1.0 / b.shear_modulus();
  const double G = 2.0 / (fa + fb);
  const double nu = 0.5 * G * (a.poissons_ratio * fa + b.poissons_ratio * fb);
  return {G, nu, 0.25 * G * ((1.0 - 2.0 * a.poissons_ratio) * fa - (1.0 - 2.0 * b.poissons_ratio) * fb)};
}

}  // namespace epafi
