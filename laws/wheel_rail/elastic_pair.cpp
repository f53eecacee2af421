#include "laws/wheel_rail/elastic_pair.h"

#include "laws/material.h"

namespace epafi {

ElasticPair elastic_pair(const Material& a, const Material& b) {
  const double fa = a.is_rigid() ? 0.0 : 1.0 / a.shear_modulus(), fb = b.is_rigid() ? 0.0 : 1.0 / b.shear_modulus();
  const double G = 2.0 / (fa + fb);
  const double nu = 0.5 * G * (a.poissons_ratio * fa + b.poissons_ratio * fb);
  return {G, nu, 0.25 * G * ((1.0 - 2.0 * a.poissons_ratio) * fa - (1.0 - 2.0 * b.poissons_ratio) * fb)};
}

}  // namespace epafi
