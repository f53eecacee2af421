/// @file dashpot.h  The springs of laws/smooth/friction.h with a dashpot beside them: T = T_spring + c v, |T| <= mu N,
/// c = 2 zeta_t sqrt(m_t k_t), 1/m_t = sum of 1/m + r^2/I. A sticking sphere then swings with zeta_t of its critical
/// damping, exactly; other bodies, whose I is taken as the harmonic mean of their moments, about that. Without it only
/// slip takes energy from the shear of a packing at rest.
#pragma once
#include <algorithm>
#include <cmath>

#include "laws/smooth/friction.h"
#include "laws/smooth/restitution.h"

namespace epafi {

/// zeta_t of spheres for c = 2 sqrt(5/6) beta sqrt(k_t m*), beta = -ln e/sqrt(ln^2 e + pi^2): the normal damping of
/// Tsuji et al. (1992) beside the tangential spring, as in LIGGGHTS and LAMMPS. m* = 7/2 m_t.
inline double tangential_damping_of(double restitution) {
  const double log = std::log(std::clamp(restitution, minimum_restitution, 1.0));
  return std::sqrt(5.0 / 6.0 * 3.5) * -log / std::hypot(log, 3.141592653589793);
}

/// Optional, so that one given to a law without dashpot is noticed.
inline Field tangential_damping_field() {
  return optional_field("tangential_damping", "zeta_t", "", Kind::number, {0, 2, false, false},
                        "damping of the tangential spring over the critical; default: that of the restitution");
}
inline double tangential_damping(const MaterialPair& pair) {
  return pair.parameters.has("tangential_damping") ? pair.parameters.number("tangential_damping")
                                                   : tangential_damping_of(pair.restitution);
}

/// Spring of fixed ratio to the normal stiffness, with dashpot.
struct SpringDashpot : CoulombSpring {
  static constexpr const char* name = "spring-dashpot";
  using Loop = CoulombSpring;

  static Entry entry() {
    Entry e = CoulombSpring::entry();
    e.name = name;
    e.summary = "tangential spring of fixed ratio to the normal stiffness with a dashpot, sliding at mu N";
    e.fields.push_back(tangential_damping_field());
    return e;
  }
  static Parameters parameters(const MaterialPair& pair) {
    Parameters p = CoulombSpring::parameters(pair);
    p.damping = tangential_damping(pair);
    return p;
  }
};
static_assert(TangentialLaw<SpringDashpot>);

/// Mindlin's no-slip stiffness with dashpot.
struct MindlinDashpot : SpringDashpot {
  static constexpr const char* name = "mindlin-dashpot";
  static constexpr Needs needs = Mindlin::needs;
  template <class N>
  static constexpr bool fits = N::is_hertzian;

  static Entry entry() {
    Entry e = Mindlin::entry();
    e.name = name;
    e.summary = "no-slip stiffness of Mindlin with a dashpot, sliding at mu N";
    e.fields.push_back(tangential_damping_field());
    e.source += "; dashpot: Tsuji, Tanaka and Ishida 1992";
    return e;
  }
  static Missing missing(const MaterialPair& pair) { return missing_elasticity(pair); }
  static Parameters parameters(const MaterialPair& pair) {
    return {pair.friction, mindlin_ratio(pair), tangential_damping(pair)};
  }
};
static_assert(TangentialLaw<MindlinDashpot>);

}  // namespace epafi
