/// @file damper.h  The force of a dashpot c beside a spring k at the end of a step of velocity Verlet, from velocities
/// known before the force is. With the velocity predicted by the last force, v_late, one contact of m* is stable while
/// k dt^2/m* + 4 c dt/m* < 4; here the contact's own change of force during the step counts in the velocity:
///   D = c (v_late - dt/(2 m*) (k dt v_middle + f (D - c v_first))),
/// v_first = 2 v_middle - v_late the velocity at the step's start, where c v_first was its force. For f = 1 that is the
/// velocity solved in the contact. f = 3 stands for the other contacts that slow the same bodies: D - c v_first is of
/// first order in dt and so is what stands before it, so that every f is of second order. Root -1 of n such contacts on
/// one body: n (dt^2/4 k + dt c (1 - dt^2 k/(4 m*))/(1 + f c dt/(2 m*))) = m (damped_weight). Steps of 2 to 8 contacts
/// at e = 0.4: 1.5 to 1.3 times those with v_late, at e = 0.11: 2.3 to 1.6; the restitution errs less (docs/laws.md).
#pragma once
#include <algorithm>

#include "engine/lanes/lanes.h"
#include "laws/lane_choice.h"

namespace epafi {

inline constexpr double damper_share = 3.0;  ///< f

/// Velocities against which a dashpot works, and how a force changes them within half a step.
template <class Real>
struct DamperStep {
  double dt = 0.0;       ///< [s]
  Real half_mobility{};  ///< dt/(2 m*) [s/kg], of rolling dt/(2 I); 0: the dashpot sees v_late
};

/// D [N], positive along the velocities, numbers or vectors: v_late predicted by the last force, v_middle in the middle
/// of the step [m/s].
template <class Real, class Velocity>
EPAFI_LANES Velocity damper_force(const DamperStep<Real>& step, const Real& dashpot, const Real& stiffness,
                                  const Velocity& v_late, const Velocity& v_middle) {
  const Real lag = damper_share * (step.half_mobility * dashpot), part = dashpot / (1.0 + lag);
  const Real of_late = part * (1.0 - lag), of_middle = part * (2.0 * lag - (step.dt * step.half_mobility) * stiffness);
  return of_late * v_late + of_middle * v_middle;
}

/// c ~ overlap^growth in a step of dt, such that impacts keep their restitution: with c itself the scheme damps more
/// than the law does, by (2 - 4/3 growth) (c dt/(2 m*))^2 of the exponent ln e (fitted to impacts by `linear`, `hertz`
/// and `hunt-crossley` of 10 to 25 steps, e from 0.05).
template <class Real>
EPAFI_LANES Real damper_in_step(const Real& half_mobility, const Real& dashpot, const Real& growth) {
  const Real share = half_mobility * dashpot;
  return dashpot / (1.0 + max(2.0 - 4.0 / 3.0 * growth, Real{}) * share * share);
}

/// Weight of a dashpot c ~ overlap^growth, growth <= 1, in the first step of a contact, else 1. moved: what the overlap
/// has grown by in the step [m]. First seen at an overlap of theta moved, 0 < theta <= 1, the dashpot has acted for
/// theta + 1/2 of a step: the weight is (theta + 1/2)^(1 + q)/((1 + q) theta^q), its powers by a Pade approximant.
/// Without it the restitution of a linear impact of e = 0.5 scatters by 8 % at 10 steps, with the time of first touch.
template <class Real>
EPAFI_LANES Real begun_share(const Real& overlap, const Real& moved, const Real& growth) {
  const Real one = Real{} + 1.0, least = Real{} + 1e-300;
  const Real way = max((1.0 + 1e-9) * moved, least);  // theta = 1 counts, whatever its rounding
  if (!any_less(overlap, way)) return one;
  const Real twice = 2.0 * max(overlap, Real{}), passed = 0.5 * (twice + way), q = min(growth, one);
  const Real turned = q * (passed - twice), mean = 1.0 - 0.25 * q * (1.0 - q);
  const Real power = mean * (passed + twice + turned) / max(passed + twice - turned, 0.01 * passed);
  return if_less(Real{}, overlap, if_less(overlap, way, passed / way * power, one), one);
}

/// c of the step before over c now: part/whole; part 0 where there was no contact.
template <class Real>
struct DashpotBefore {
  Real part{}, whole{};
};

/// Of c ~ overlap^q, `moved` = dt v_middle ago: (1 - moved/overlap)^q by Pade's quotient [1/1]: more terms cost 3 % of
/// a step. q > 1: the quotient has a pole where the overlap was five times as deep, which `whole` keeps away from.
template <class Real>
EPAFI_LANES DashpotBefore<Real> dashpot_before(const Real& overlap, const Real& moved, const Real& growth) {
  const Real half = 0.5 * moved, turned = growth * half;
  const Real part = max(Real{}, overlap - half - turned), whole = max(overlap - half + turned, 0.5 * overlap);
  return {select(overlap > moved, part, Real{}), whole};
}

/// Of a contact now, for the balance of energy.
template <class Real>
struct DampedContact {
  Real elastic{};    ///< what its spring pushes with, and adhesion could pull [N]: no dashpot pulls with more
  Real stiffness{};  ///< [N/m]
  Real dashpot{};    ///< [N s/m]
  DashpotBefore<Real> before{};
};

/// What a dashpot that pushes with D loses [W], such that the trapezoid of its steps is the work of D on the way that
/// the bodies go. Sum of D_n v_n, v_n = v_middle + dt/2 a_n the velocity that step n ends with: a_n, of all contacts,
/// is known in the next step alone, where it is (v_late - v_middle) 2/dt. So each step tells D v_middle and what the
/// force before it still owes, D_before dt/2 a. D_before is found anew from the velocities of its step, with the
/// dashpot of then. Contacts do not pull, so that it is at least the spring's force then. It errs by the third order in
/// dt. Told with the velocity that the last acceleration predicts, a column of four under a load was open by 5e-3, a
/// lone impact at e = 0.1 by 4e-2.
template <class Real>
EPAFI_LANES Real dashpot_power(const DamperStep<Real>& step, const Real& push, const Real& v_late, const Real& v_middle,
                               const DampedContact<Real>& now) {
  const Real gained = v_late - v_middle, first = v_middle - gained, before = first - gained;
  const Real part = now.before.part, whole = now.before.whole;
  const Real lag = damper_share * (step.half_mobility * now.dashpot);
  const Real spring = (step.dt * step.half_mobility) * now.stiffness;
  const Real top = now.dashpot * part * ((whole - lag * part) * first + (2.0 * lag * part - spring * whole) * before);
  const Real spring_before = max(Real{}, now.elastic - now.stiffness * (step.dt * v_middle));
  const Real push_before = max(top / max(whole * (whole + lag * part), Real{} + 1e-300), -spring_before);
  return push * v_middle + push_before * gained;
}

/// dt^2/4 k and what the dashpot adds to it where the contact's force alternates from step to step [kg]: a body is
/// stable while the sum of its contacts stays below its mass. mobility: 1/m* [1/kg].
inline double damped_weight(double stiffness, double dashpot, double mobility, double dt) {
  const double spring = 0.25 * dt * dt * stiffness, damper = dt * damper_in_step(0.5 * dt * mobility, dashpot, 0.0);
  return spring + damper * std::max(0.0, 1.0 - spring * mobility) / (1.0 + 0.5 * damper_share * damper * mobility);
}

/// Of a contact alone, whose other root decides: to 10 % on the safe side, from e = 0.4 to overdamped.
inline double lone_damped_weight(double stiffness, double dashpot, double mobility, double dt) {
  const double damper = damper_in_step(0.5 * dt * mobility, dashpot, 0.0);
  const double other = 0.25 * dt * dt * stiffness + dt * damper / damper_share;
  return std::max(damped_weight(stiffness, dashpot, mobility, dt), other);
}

}  // namespace epafi
