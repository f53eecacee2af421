/// @file elastic_pair.h  Combined elastic constants of two half-spaces, for the patch models of wheel and rail.
#pragma once

namespace epafi {

struct Material;

/// Combined constants of two half-spaces (Kalker 1990, eq. 1.44): 1/G and nu/G are means over the two bodies.
/// Unlike bodies also couple pressure and traction (Kalker's K); that coupling is left out and flagged by the caller.
struct ElasticPair {
  double shear_modulus = 0.0;   ///< G [Pa], > 0
  double poissons_ratio = 0.0;  ///< nu [-], in (-1, 0.5]
  double coupling = 0.0;        ///< K = G/4 ((1 - 2 nu_a)/G_a - (1 - 2 nu_b)/G_b) [-]; 0 for equal materials

  /// E* = G / (1 - nu) [Pa]
  double effective_modulus() const { return shear_modulus / (1.0 - poissons_ratio); }
};

ElasticPair elastic_pair(const Material& a, const Material& b);

}  // namespace epafi
