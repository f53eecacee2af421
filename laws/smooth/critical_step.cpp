#include "laws/smooth/critical_step.h"

#include "laws/smooth/restitution.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "laws/smooth/asked_law.h"
#include "laws/smooth/choose_law.h"

namespace epafi {

namespace {

using std::numbers::pi;

std::string number(double value, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.3g %s", value, unit);
  return text;
}

/// A flat face as wide as the effective radius is the stiffest cell of overlap volume.
ContactKinematics kinematics(const ExpectedContact& c, double overlap, double velocity) {
  return {overlap, velocity, c.effective_mass, c.effective_radius, pi * c.effective_radius * c.effective_radius};
}

double moved_mass(const ExpectedContact& c) { return c.moved_mass > 0.0 ? c.moved_mass : c.effective_mass; }

/// delta'' = -N/m from first touch until the force has ended.
ImpactEstimate integrate_impact(const AskedLaw& law, const ExpectedContact& c, double dt) {
  ImpactEstimate out;
  double state = 0.0, next = 0.0;
  const auto force = [&](double overlap, double velocity) {
    return law.respond(kinematics(c, std::max(overlap, 0.0), velocity), state, next).force;
  };
  const double mass = moved_mass(c);
  const auto acceleration = [&](double overlap, double velocity) { return -force(overlap, velocity) / mass; };
  double x = 0.0, v = c.speed;
  for (int k = 0; k < 100000; ++k) {
    const double a1 = acceleration(x, v), v2 = v + 0.5 * dt * a1;
    const double a2 = acceleration(x + 0.5 * dt * v, v2), v3 = v + 0.5 * dt * a2;
    const double a3 = acceleration(x + 0.5 * dt * v2, v3), v4 = v + dt * a3;
    const double a4 = acceleration(x + dt * v3, v4);
    x += dt / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
    v += dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    const double now = force(x, v);
    state = next;
    out.contact_time += dt;
    out.largest_overlap = std::max(out.largest_overlap, x);
    out.largest_force = std::max(out.largest_force, now);
    if (v < 0.0 && (now <= 0.0 || x <= 0.0)) break;
  }
  out.restitution = -v / c.speed;
  return out;
}

/// Contact time without damping, the scale of the integration [s]: pi delta_max / v, exact for a linear spring and 7 %
/// more than Hertz's, with delta_max where elastic energy and plastic loss have taken up the motion.
double elastic_contact_time(const AskedLaw& law, const ExpectedContact& c) {
  const double motion = 0.5 * moved_mass(c) * c.speed * c.speed;
  const auto taken = [&](double overlap) {
    const NormalResponse r = law.first(kinematics(c, overlap, 0.0));
    return r.energy + r.lost;
  };
  double low = 0.0, high = 1e-12;
  while (taken(high) < motion) high *= 2.0;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (taken(middle) < motion ? low : high) = middle;
  }
  return pi * high / c.speed;
}

/// Elastic stiffness and dashpot at an overlap [N/m, N s/m].
struct Slopes {
  double stiffness, dashpot;
};
Slopes slopes_at(const AskedLaw& law, const ExpectedContact& c, double overlap) {
  const NormalResponse still = law.first(kinematics(c, overlap, 0.0));
  const NormalResponse moving = law.first(kinematics(c, overlap, c.speed));
  return {still.stiffness, (moving.force - still.force) / c.speed};
}

/// Normal dashpot with the same step limit as that of the friction spring on a solid sphere, whose tangential mobility
/// is 7/2 of the normal one [N s/m].
double tangential_dashpot(const std::string& tangential, const MaterialPair& pair, double normal_stiffness,
                          double effective_mass) {
  return with_law(TangentialLaws{}, tangential, [&](auto t) {
    using T = typename decltype(t)::type;
    [[maybe_unused]] const auto p = T::parameters(pair);
    if constexpr (requires { p.damping; })
      return 3.5 * 2.0 * p.damping * std::sqrt(T::stiffness(p, normal_stiffness) * effective_mass / 3.5);
    else
      return 0.0;
  });
}

}  // namespace

double hertz_contact_time(double m, double radius, double modulus, double speed) {
  // 2 (15/16)^(2/5) sqrt(pi) Gamma(7/5) / Gamma(9/10)
  constexpr double factor = 2.868265699195333;
  return factor * std::pow(m * m / (radius * modulus * modulus * speed), 0.2);
}

double fall_speed(double gravity, double height) { return std::sqrt(2.0 * std::abs(gravity) * std::max(height, 0.0)); }

ImpactEstimate estimate_impact(const SmoothSetup& setup, const MaterialPair& pair, const ExpectedContact& contact) {
  return critical_step(setup, pair, contact).impact;
}

StepLimit critical_step(const SmoothSetup& setup, const MaterialPair& pair, const ExpectedContact& given) {
  const SmoothParts parts = smooth_parts(setup);
  const AskedLaw law = asked_law(parts.normal, pair);
  ExpectedContact c = given;
  if (!law.is_hertzian && !(c.speed > 0.0)) c.speed = 1.0;  // the contact time of the linear law does not depend on it
  StepLimit out;
  out.impact = integrate_impact(law, c, elastic_contact_time(law, c) / 4000);
  const Slopes slope = slopes_at(law, c, out.impact.largest_overlap);
  const double sideways = tangential_dashpot(parts.tangential, pair, slope.stiffness, c.effective_mass);
  // A contact first sampled at overlap theta h, h = v dt, loses k h^2/12 on average beyond its stored energy, and the
  // last sample gains k h^2/12 at a lower speed: over many impacts (pi dt/t_c)^2/6 of all losses, 1.6 %.
  const double by_time = c.part * out.impact.contact_time;
  // an explicit damper of c overshoots beyond m*/c: half of it; e = 0.01 (c = 9.4 sqrt(m* k)) then takes 60 steps per
  // contact
  const double dashpot = std::max(slope.dashpot, sideways);
  const double by_damping = dashpot > 0.0 ? 0.5 * moved_mass(c) / dashpot : by_time;
  out.auto_step = std::min(by_time, by_damping);
  out.reason = number(c.part, "of its contact time ") + number(out.impact.contact_time, "s");
  if (out.auto_step < by_time) out.reason = "half of m*/c of its damper";
  if (law.is_hertzian) out.reason += " at " + number(c.speed, "m/s");
  return out;
}

}  // namespace epafi
