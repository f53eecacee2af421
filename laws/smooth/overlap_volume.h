/// @file overlap_volume.h  Force proportional to the overlap volume, for polyhedra (Munjiza 2004, potential contact).
/// The overlap acts as an elastic layer of thickness l: pressure E*/l times the depth. The force is the gradient of a
/// potential of the poses (detection/narrow/polyhedra/overlap_cells.h), so that energy is conserved at e = 1 through
/// every change of face, edge and corner. A flat face is a linear spring E* A/l; a corner starts softly, N ~ delta^3.
#pragma once
#include <algorithm>
#include <cmath>

#include "laws/smooth/hertz.h"

namespace epafi {

/// N = max(0, k delta + 2 zeta sqrt(m* k) delta_dot), k = E* A/(layer R*), A the mean area of the cell
struct OverlapVolume {
  static constexpr const char* name = "overlap-volume";
  static constexpr Needs needs{.curvature = true, .area = true};
  static constexpr bool is_hertzian = false;
  /// exp(-2), of critical damping: polyhedra that fall flat, on a corner or turning return different speeds anyway, and
  /// the overdamped spring of e = 0.01 would cost five times the steps.
  static constexpr double least_restitution = 0.1353352832366127;
  template <class Real>
  struct ParametersOf {
    Real modulus;        ///< E*/layer [Pa], > 0
    Real damping_ratio;  ///< zeta [-], >= 0; 0 is elastic
  };
  using Parameters = ParametersOf<double>;

  static Entry entry() {
    return {name,
            "elastic layer of the overlap volume of polyhedra, never pulls",
            {{"layer", "l/R*", "", Kind::number, Value{0.5}, positive,
              "thickness of the elastic layer over the effective radius: flat faces are springs E* A/l"}},
            needs,
            "Munjiza 2004; damping by Schwager and Poeschel 2007"};
  }
  static Missing missing(const MaterialPair& pair) { return missing_elasticity(pair); }
  static Parameters parameters(const MaterialPair& pair) {
    return {pair.effective_modulus() / number_or_default(pair.parameters, entry(), "layer"),
            damping_ratio_for(std::max(pair.restitution, least_restitution))};
  }
  static bool is_damped(const Parameters& p) { return p.damping_ratio > 0.0; }
  template <class Real>
  EPAFI_LANES static ResponseOf<Real> respond(const ParametersOf<Real>& p, const KinematicsOf<Real>& c) {
    const Real stiffness = p.modulus * c.area / c.effective_radius;
    const Real elastic = stiffness * c.overlap;
    const Real dashpot = 2.0 * p.damping_ratio * sqrt(c.effective_mass * stiffness);
    const Real growth = Real{} + 0.5;  // a face 0, an edge 1/2, a corner 1
    const Real force = max(Real{}, elastic + c.viscous(dashpot, stiffness, growth));
    return {.force = force,
            .elastic_force = elastic,
            .stiffness = stiffness,
            .energy = 0.5 * elastic * c.overlap,
            .dashpot = dashpot,
            .growth = growth};
  }
};
static_assert(LaneLaw<OverlapVolume>);

}  // namespace epafi
