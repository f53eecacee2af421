/// @file adhesion.h  Adhesive elastic spheres: DMT (Derjaguin, Muller and Toporov 1975) for small stiff ones, JKR
/// (Johnson, Kendall and Roberts 1971) for large soft ones. Both lose their grip at a force, DMT 2 pi w R*, JKR
/// 3/2 pi w R*; friction slides at mu (N + that force). Damping as in hertz: `restitution` is that of an impact so fast
/// that adhesion does not count; slow ones return less, and below a speed they stick.
#pragma once
#include "laws/smooth/hertz.h"

namespace epafi {

inline Field adhesion_field() {
  return {"work_of_adhesion", "w", "J/m^2", Kind::number, {}, not_negative, "energy per area to part the surfaces"};
}
inline Missing missing_adhesion(const MaterialPair& pair) {
  Missing out = missing_elasticity(pair);
  if (!pair.parameters.has("work_of_adhesion")) out.push_back("work_of_adhesion [J/m^2] of the contact");
  return out;
}

struct AdhesionParameters {
  double modulus;  ///< E* of the pair [Pa], > 0
  double damping;  ///< as Hertz
  double work;     ///< w [J/m^2], >= 0
};

inline AdhesionParameters adhesion_parameters(const MaterialPair& pair) {
  const Hertz::Parameters hertz = Hertz::parameters(pair);
  return {hertz.modulus, hertz.damping, pair.parameters.number("work_of_adhesion")};
}

/// N = Hertz with its damping - 2 pi w R*, while the bodies overlap. Conservative without damping: the way out is the
/// way in.
struct Dmt {
  static constexpr const char* name = "dmt";
  static constexpr Needs needs{.curvature = true};
  static constexpr bool is_hertzian = true;
  using Parameters = AdhesionParameters;

  static Entry entry() {
    return {name,
            "Hertz with constant attraction in contact",
            {adhesion_field()},
            needs,
            "Derjaguin, Muller and Toporov 1975"};
  }
  static Missing missing(const MaterialPair& pair) { return missing_adhesion(pair); }
  static Parameters parameters(const MaterialPair& pair) { return adhesion_parameters(pair); }
  static bool is_damped(const Parameters& p) { return p.damping > 0.0; }
  static NormalResponse respond(const Parameters& p, const ContactKinematics& c) {
    NormalResponse out = Hertz::respond({p.modulus, p.damping}, c);
    out.adhesion = 6.283185307179586 * p.work * c.effective_radius;
    out.force -= out.adhesion, out.elastic_force -= out.adhesion;
    out.energy -= out.adhesion * c.overlap;
    return out;
  }
};
static_assert(NormalLaw<Dmt>);

/// With a the contact radius: delta = a^2/R* - sqrt(2 pi w a/E*), N = 4/3 E* a^3/R* - sqrt(8 pi w E* a^3). The contact
/// snaps in at delta = 0 and holds on to delta = -3/4 (pi^2 w^2 R*/E*^2)^(1/3), where it breaks; what the bodies do not
/// get back is lost to adhesion.
struct Jkr {
  static constexpr const char* name = "jkr";
  static constexpr Needs needs{.memory = true, .curvature = true};
  static constexpr bool is_hertzian = true;
  using Parameters = AdhesionParameters;
  struct State {
    double root = 0.0;  ///< sqrt(a) of a contact that holds [m^(1/2)]; 0: none
  };

  static Entry entry() {
    return {name,
            "adhesive spheres that hold on beyond touch",
            {adhesion_field()},
            needs,
            "Johnson, Kendall and Roberts 1971"};
  }
  static Missing missing(const MaterialPair& pair) { return missing_adhesion(pair); }
  static Parameters parameters(const MaterialPair& pair) { return adhesion_parameters(pair); }
  static bool is_damped(const Parameters& p) { return p.damping > 0.0; }
  static bool holds(const State& s) { return s.root > 0.0; }
  /// How far beyond touch a contact holds [m].
  static double reach(const Parameters& p, double radius) {
    const double third = std::cbrt(9.869604401089358 * p.work * p.work * radius / (p.modulus * p.modulus));
    return 0.75 * third;
  }
  static NormalResponse respond(const Parameters& p, const ContactKinematics& c, const State& before, State& now);

 private:
  static double energy(const Parameters& p, double radius, double grip, double root);
};

/// U along the branch of equilibria from a = 0, with u = sqrt(a), B = sqrt(2 pi w/E*):
/// E* (8/15 u^10/R*^2 - 4/3 B u^7/R* + B^2 u^4/2)
inline double Jkr::energy(const Parameters& p, double radius, double grip, double root) {
  const double u3 = root * root * root, u4 = u3 * root;
  return p.modulus *
         (8.0 / 15.0 * u3 * u3 * u4 / (radius * radius) - 4.0 / 3.0 * grip * u4 * u3 / radius + 0.5 * grip * grip * u4);
}

inline NormalResponse Jkr::respond(const Parameters& p, const ContactKinematics& c, const State& before, State& now) {
  const double R = c.effective_radius, B = std::sqrt(6.283185307179586 * p.work / p.modulus);
  const auto snap = [&] { return std::cbrt(B * R); };  // u at delta = 0
  NormalResponse out;
  if (!holds(before)) {
    if (!(c.overlap > 0.0)) return out;
    out.lost = -energy(p, R, B, snap());  // what the surfaces gain in meeting, as heat
  }
  double floor = 0.0;
  if (c.overlap < 0.0) {
    const double u_break = 0.6299605249474366 * snap();  // u^3 = B R/4, the least delta of the branch
    if (c.overlap < u_break * u_break * u_break * u_break / R - B * u_break) {
      now.root = 0.0;
      out.lost += energy(p, R, B, u_break);
      return out;
    }
    floor = u_break * (1.0 + 1e-9);
  }
  // u^4/R - B u = delta is convex and rising on the branch: Newton from above falls to the root; from the last root,
  // which is near, in two or three steps, unless it lies where the branch is flat
  double u = before.root;
  if (u * u * u <= 0.75 * B * R || c.overlap < 0.0)
    u = std::max(before.root, snap()) + std::sqrt(std::sqrt(R * std::max(c.overlap, 0.0)));
  for (int k = 0; k < 60; ++k) {
    const double cube = u * u * u / R, next = std::max(u - ((cube - B) * u - c.overlap) / (4.0 * cube - B), floor);
    const bool done = std::abs(next - u) <= 1e-15 * u;
    u = next;
    if (done) break;
  }
  now.root = u;
  const double a = u * u, stiffness = 2.0 * p.modulus * a;
  const double elastic =
      4.0 / 3.0 * p.modulus * a * a * a / R - 2.0 * p.modulus * B * a * u;  // sqrt(8 pi w E* a^3) = 2 E* B a^(3/2)
  const double viscous = p.damping * std::sqrt(c.effective_mass * stiffness) * c.approach_velocity;
  out.adhesion = 4.71238898038469 * p.work * R;
  out.elastic_force = elastic, out.energy = energy(p, R, B, u), out.stiffness = stiffness;
  // the dashpot may not pull more than the adhesion holds
  out.force = std::max(elastic + viscous, std::min(elastic, -out.adhesion));
  return out;
}
static_assert(NormalLaw<Jkr>);

}  // namespace epafi
