/// @file walton_braun.h  Hysteretic springs: soft while the overlap grows beyond all before, stiff when it falls
/// (Walton and Braun 1986). Energy is lost to plastic deformation, not to a rate: restitution sqrt(k_1/k_2) is exact at
/// every speed, for every mass, and there is no dashpot to resolve. Remembers the largest overlap while the contact
/// lasts.
#pragma once
#include <algorithm>
#include <cmath>

#include "laws/contact_law.h"

namespace epafi {

/// Loading N = k_1 delta; below the largest overlap delta_m: N = max(0, k_2 (delta - (1 - e^2) delta_m)), k_2 = k_1/e^2
struct WaltonBraun {
  static constexpr const char* name = "walton-braun";
  static constexpr Needs needs{.memory = true};
  static constexpr bool is_hertzian = false;
  /// k_2 = 400 k_1, and a twentieth of the time step.
  static constexpr double least_restitution = 0.05;
  template <class Real>
  struct ParametersOf {
    Real loading;    ///< k_1 [N/m], > 0
    Real unloading;  ///< k_2 [N/m], >= k_1
  };
  using Parameters = ParametersOf<double>;
  template <class Real>
  struct StateOf {
    Real largest_overlap{};  ///< delta_m [m]
  };
  using State = StateOf<double>;

  static Entry entry() {
    return {name,
            "two springs, plastic loss, no dashpot",
            {{"stiffness", "k_1", "N/m", Kind::number, {}, positive, "stiffness of first loading"}},
            needs,
            "Walton and Braun 1986"};
  }
  static Missing missing(const MaterialPair& pair) {
    return pair.parameters.has("stiffness") ? Missing{} : Missing{"stiffness [N/m] of the contact"};
  }
  static Parameters parameters(const MaterialPair& pair) {
    const double e = std::max(pair.restitution, least_restitution), k = pair.parameters.number("stiffness");
    return {k, k / (e * e)};
  }
  static bool is_damped(const Parameters&) { return false; }
  template <class Real>
  EPAFI_LANES static ResponseOf<Real> respond(const ParametersOf<Real>& p, const KinematicsOf<Real>& c,
                                              const StateOf<Real>& before, StateOf<Real>& now) {
    now.largest_overlap = max(before.largest_overlap, c.overlap);
    const Real part = p.loading / p.unloading;  // e^2
    const Real force = max(Real{}, p.unloading * (c.overlap - (1.0 - part) * now.largest_overlap));
    // first loading from delta_m to delta_m' stores k_1^2 delta_m'^2 / (2 k_2) and loses the rest of k_1 delta_m'^2 / 2
    const Real factor = 0.5 * p.loading * (1.0 - part);
    ResponseOf<Real> out{force, force, p.unloading, 0.5 * force * force / p.unloading};
    out.lost =
        factor * now.largest_overlap * now.largest_overlap - factor * before.largest_overlap * before.largest_overlap;
    return out;
  }
};
static_assert(LaneLaw<WaltonBraun>);

}  // namespace epafi
