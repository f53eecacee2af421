/// @file adhesion.h  Adhesive elastic spheres: DMT (Derjaguin, Muller and Toporov 1975) for small stiff ones, JKR
/// (Johnson, Kendall and Roberts 1971) for large soft ones. Pull-off force: DMT 2 pi w R*, JKR 3/2 pi w R*; friction
/// slides at mu (N + that force). Damping as in hertz: `restitution` holds for impacts so fast that adhesion is
/// negligible; slower ones rebound less, and below a speed bodies stick.
#pragma once
#include "laws/lane_choice.h"
#include "laws/smooth/hertz.h"

namespace epafi {

inline Entry adhesion_entry(const char* name, const char* summary, Needs needs, const char* source) {
  return {name,
          summary,
          {{"work_of_adhesion", "w", "J/m^2", Kind::number, {}, not_negative, "work of separation per area"}},
          needs,
          source};
}
template <class Real>
struct AdhesionParameters {
  Real modulus;  ///< E* of the pair [Pa], > 0
  Real damping;  ///< as Hertz
  Real work;     ///< w [J/m^2], >= 0
};
inline Missing missing_adhesion(const MaterialPair& pair) {
  Missing out = missing_elasticity(pair);
  if (!pair.parameters.has("work_of_adhesion")) out.push_back("work_of_adhesion [J/m^2] of the contact");
  return out;
}

/// N = Hertz with its damping - 2 pi w R*, while the bodies overlap. Conservative without damping, since loading and
/// unloading have the same force.
struct Dmt {
  static constexpr const char* name = "dmt";
  static constexpr Needs needs{.curvature = true};
  static constexpr bool is_hertzian = true;
  template <class Real>
  using ParametersOf = AdhesionParameters<Real>;
  using Parameters = ParametersOf<double>;

  static Entry entry() {
    return adhesion_entry(name, "Hertz with constant attraction in contact", needs,
                          "Derjaguin, Muller and Toporov 1975");
  }
  static Missing missing(const MaterialPair& pair) { return missing_adhesion(pair); }
  static Parameters parameters(const MaterialPair& pair) {
    const Hertz::Parameters hertz = Hertz::parameters(pair);
    return {hertz.modulus, hertz.damping, pair.parameters.number("work_of_adhesion")};
  }
  static bool is_damped(const Parameters& p) { return p.damping > 0.0; }
  template <class Real>
  EPAFI_LANES static ResponseOf<Real> respond(const ParametersOf<Real>& p, const KinematicsOf<Real>& c) {
    ResponseOf<Real> out = Hertz::respond(Hertz::ParametersOf<Real>{p.modulus, p.damping}, c);
    out.adhesion = 6.283185307179586 * p.work * c.effective_radius;
    out.force -= out.adhesion;
    out.elastic_force -= out.adhesion;
    out.energy -= out.adhesion * c.overlap;
    return out;
  }
};
static_assert(LaneLaw<Dmt>);

/// With a the contact radius: delta = a^2/R* - sqrt(2 pi w a/E*), N = 4/3 E* a^3/R* - sqrt(8 pi w E* a^3). The contact
/// forms at delta = 0 and breaks at delta = -3/4 (pi^2 w^2 R*/E*^2)^(1/3); the difference of energy is lost to
/// adhesion.
struct Jkr {
  static constexpr const char* name = "jkr";
  static constexpr Needs needs{.memory = true, .curvature = true};
  static constexpr bool is_hertzian = true;
  template <class Real>
  struct ParametersOf : AdhesionParameters<Real> {
    Real grip;  ///< B = sqrt(2 pi w/E*) [m^(1/2)]
  };
  using Parameters = ParametersOf<double>;
  template <class Real>
  struct StateOf {
    Real root{};  ///< sqrt(a) of a contact that holds [m^(1/2)]; 0: none
  };
  using State = StateOf<double>;

  static Entry entry() {
    return adhesion_entry(name, "adhesive spheres in contact until pull-off", needs,
                          "Johnson, Kendall and Roberts 1971");
  }
  static Missing missing(const MaterialPair& pair) { return missing_adhesion(pair); }
  static Parameters parameters(const MaterialPair& pair) {
    const Dmt::Parameters p = Dmt::parameters(pair);
    return {p, std::sqrt(6.283185307179586 * p.work / p.modulus)};
  }
  static bool is_damped(const Parameters& p) { return p.damping > 0.0; }
  static bool holds(const State& s) { return s.root > 0.0; }
  /// Gap up to which a contact holds [m].
  static double reach(const Parameters& p, double radius) {
    const double third = std::cbrt(9.869604401089358 * p.work * p.work * radius / (p.modulus * p.modulus));
    return 0.75 * third;
  }
  /// U along the branch of equilibria from a = 0, with u = sqrt(a): E* (8/15 u^10/R*^2 - 4/3 B u^7/R* + B^2 u^4/2)
  template <class Real>
  EPAFI_LANES static Real energy(const ParametersOf<Real>& p, Real curvature, Real u) {
    const Real u3 = u * u * u, u4 = u3 * u;
    return p.modulus * (8.0 / 15.0 * u3 * u3 * u4 * (curvature * curvature) - 4.0 / 3.0 * p.grip * u4 * u3 * curvature +
                        0.5 * p.grip * p.grip * u4);
  }

  template <class Real>
  EPAFI_LANES static ResponseOf<Real> respond(const ParametersOf<Real>& p, const KinematicsOf<Real>& c,
                                              const StateOf<Real>& before, StateOf<Real>& now) {
    const Real R = c.effective_radius, B = p.grip, curvature = 1.0 / R, none{}, one = Real{} + 1.0, old = before.root;
    // conditions are numbers, 1 or 0 (laws/lane_choice.h)
    const Real held = if_less(none, old, one, none), touches = if_less(none, c.overlap, one, none);
    const Real begins = touches * (1.0 - held), beyond = if_less(c.overlap, none, held, none);
    Real alive = max(held, touches);
    // u^4/R - B u = delta is convex and rising on the branch: Newton from above falls to the root, where the branch is
    // flat too. From the last root, which is near, one step with two more terms of the series of the inverse is exact.
    const Real flat = max(if_less(0.75 * B * R, old * old * old, none, alive), beyond);
    ResponseOf<Real> out;
    Real u = old, least{};
    if (any_less(none, flat)) {
      const Real snap = cube_root(B * R), u_break = 0.6299605249474366 * snap;  // u at delta = 0; the end of the branch
      const Real last = u_break * u_break * u_break * u_break * curvature - B * u_break;
      const Real breaks = if_less(c.overlap, last, beyond, none);
      // in meeting the surfaces gain energy, as heat; in parting they do not get it back
      out.lost = if_less(none, breaks, energy(p, curvature, u_break), none) -
                 if_less(none, begins, energy(p, curvature, snap), none);
      alive = alive - breaks;
      least = if_less(none, beyond, u_break * (1.0 + 1e-9), none);
      u = if_less(none, flat, max(old, snap) + sqrt(sqrt(R * max(c.overlap, none))), old);
    }
    u = if_less(none, alive, u, one);
    Real open = alive;  // each lane by its own condition alone: the same bits for every number of lanes
    for (int k = 0; k < 60 && any_less(none, open); ++k) {
      const Real cube = u * u * u * curvature, inverse = 1.0 / (4.0 * cube - B);
      const Real move = ((cube - B) * u - c.overlap) * inverse, bend = 4.0 * curvature * inverse * u * move;
      const Real next = 1.5 * u * bend, size = max(next, -next);  // second term of the series over the first
      const Real series = if_less(size, 0.1 * one, 1.0 + next + 2.0 * next * next - bend * move, one);
      u = if_less(none, open, max(u - move * series, least), u);
      const Real error = size * size * size * move;
      open = if_less(1e-17 * u, max(error, -error), open, none);
    }
    now.root = if_less(none, alive, u, none);
    const Real a = u * u;
    out.stiffness = if_less(none, alive, 2.0 * p.modulus * a, none);
    out.elastic_force = if_less(  // sqrt(8 pi w E* a^3) = 2 E* B a^(3/2)
        none, alive, 4.0 / 3.0 * p.modulus * a * a * a * curvature - 2.0 * p.modulus * B * a * u, none);
    const Real begun = begun_share<Real>(c.overlap, c.step.dt * c.middle_velocity, none);
    out.dashpot = begun * p.damping * (now.root * sqrt(2.0 * p.modulus * c.effective_mass));  // sqrt(m* k)
    const Real viscous = c.viscous(out.dashpot, out.stiffness);
    out.adhesion = if_less(none, alive, 4.71238898038469 * p.work * R, none);
    out.energy = if_less(none, alive, energy(p, curvature, u), none);
    // the dashpot may not pull more than the adhesion holds
    out.force = max(out.elastic_force + viscous, min(out.elastic_force, -out.adhesion));
    return out;
  }
};
static_assert(LaneLaw<Jkr>);

}  // namespace epafi
