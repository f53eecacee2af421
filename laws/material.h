/// @file material.h  Materials and what a pair of materials means to a contact. Walls and bodies obey the same rules.
#pragma once
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "engine/units/registry.h"

namespace epafi {

/// Elastic constants and density of one material, SI. NaN where the scene does not give one: whoever needs it refuses
/// by name.
struct Material {
  std::string name;
  double density = std::numeric_limits<double>::quiet_NaN();         ///< rho [kg/m^3], > 0
  double youngs_modulus = std::numeric_limits<double>::quiet_NaN();  ///< E [Pa], > 0; infinity is rigid
  double poissons_ratio = std::numeric_limits<double>::quiet_NaN();  ///< nu [-], in (-1, 0.5]
  bool is_rigid() const { return std::isinf(youngs_modulus); }
  double shear_modulus() const { return youngs_modulus / (2.0 * (1.0 + poissons_ratio)); }  ///< G [Pa]
};

/// Properties of one unordered pair of materials in the scene.
struct MaterialPair {
  Material a, b;
  double restitution = 0.0;       ///< e [-], in [0, 1]
  double friction = 0.0;          ///< mu [-], >= 0
  double rolling_friction = 0.0;  ///< mu_r [-], >= 0
  Parameters parameters{};        ///< of the smooth law, by field name
  bool occurs = true;             ///< bodies of the two can touch; where not (wall and wall), constants may be missing

  /// 1/E* = (1 - nu_a^2)/E_a + (1 - nu_b^2)/E_b [Pa]  (Johnson 1985, eq. 4.24); rigid: E = infinity
  double effective_modulus() const {
    const auto compliance = [](const Material& m) {
      return m.is_rigid() ? 0.0 : (1.0 - m.poissons_ratio * m.poissons_ratio) / m.youngs_modulus;
    };
    return 1.0 / (compliance(a) + compliance(b));
  }
  /// 1/G* = (2 - nu_a)/G_a + (2 - nu_b)/G_b [Pa]  (Mindlin 1949)
  double effective_shear_modulus() const {
    const auto compliance = [](const Material& m) {
      return m.is_rigid() ? 0.0 : (2.0 - m.poissons_ratio) / m.shear_modulus();
    };
    return 1.0 / (compliance(a) + compliance(b));
  }
};

/// All pairs of n materials, looked up by the material columns of two bodies.
struct MaterialTable {
  std::size_t materials = 0;
  std::vector<MaterialPair> pairs;  ///< pairs[i * materials + j], symmetric
  const MaterialPair& of(std::uint16_t i, std::uint16_t j) const { return pairs[i * materials + j]; }
};

}  // namespace epafi
