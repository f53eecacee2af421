/// @file damper.h  Force of a dashpot c beside a spring k at the end of a step of velocity Verlet, from velocities
/// known before the force is. With v_late, the velocity predicted from the last force, a contact of effective mass m*
/// is stable for k dt^2/m* + 4 c dt/m* < 4. Here the velocity also contains the contact's own change of force in the
/// step:
///   D = c (v_late - dt/(2 m*) (k dt v_middle + f (D - c v_first))),
/// with v_first = 2 v_middle - v_late, the velocity at the start of the step, and c v_first the force there. f = 1 is
/// the implicit solution of the contact alone; f = 3 accounts for other contacts that slow the same bodies. Every f is
/// of second order, because D - c v_first and its factor are of first order in dt. Stability limit (amplification
/// factor -1) of n such contacts on one body: n (dt^2/4 k + dt c (1 - dt^2 k/(4 m*))/(1 + f c dt/(2 m*))) = m
/// (damped_weight). Stable steps with 2 to 8 contacts: 1.5 to 1.3 times those with v_late at e = 0.4, 2.3 to 1.6 times
/// at e = 0.11; the error of the restitution is smaller too (docs/laws.md).
#pragma once
#include <algorithm>

#include "engine/lanes/lanes.h"
#include "laws/lane_choice.h"

namespace epafi {

inline constexpr double damper_share = 3.0;  ///< f

/// Step and mobility: how a force changes the velocity of a dashpot within half a step.
template <class Real>
struct DamperStep {
  double dt = 0.0;       ///< [s]
  Real half_mobility{};  ///< dt/(2 m*) [s/kg], of rolling dt/(2 I); 0: D = c v_late
  double before = 1.0;   ///< the step before over this one; 0 in the first step of a run
};

/// DamperStep::before of one step after the other.
struct StepRatio {
  double last = 0.0;  ///< [s]
  double next(double dt) {
    if (!(dt > 0.0)) return 1.0;
    const double before = last;
    last = dt;
    return before / dt;
  }
};

/// D [N], positive along the velocities (numbers or vectors). v_late: predicted from the last force; v_middle: in the
/// middle of the step [m/s].
template <class Real, class Velocity>
EPAFI_LANES Velocity damper_force(const DamperStep<Real>& step, const Real& dashpot, const Real& stiffness,
                                  const Velocity& v_late, const Velocity& v_middle) {
  const Real lag = damper_share * (step.half_mobility * dashpot), part = dashpot / (1.0 + lag);
  const Real of_late = part * (1.0 - lag), of_middle = part * (2.0 * lag - (step.dt * step.half_mobility) * stiffness);
  return of_late * v_late + of_middle * v_middle;
}

/// c over what acts of c ~ overlap^growth in a step of dt, such that impacts keep their restitution: with c itself the
/// scheme damps more than the law does, by (2 - 4/3 growth) (c dt/(2 m*))^2 of the exponent ln e (fitted to impacts by
/// `linear`, `hertz` and `hunt-crossley` of 10 to 25 steps, e from 0.05).
template <class Real>
EPAFI_LANES Real damper_excess(const Real& half_mobility, const Real& dashpot, const Real& growth) {
  const Real share = half_mobility * dashpot;
  return 1.0 + max(2.0 - 4.0 / 3.0 * growth, Real{}) * share * share;
}
template <class Real>
EPAFI_LANES Real damper_in_step(const Real& half_mobility, const Real& dashpot, const Real& growth) {
  return dashpot / damper_excess<Real>(half_mobility, dashpot, growth);
}

/// Weight of a dashpot c ~ overlap^growth, growth <= 1, in the first step of a contact, 0 before, else 1. moved: what
/// the overlap has grown by in the step [m]. First seen at an overlap of theta moved, 0 < theta <= 1, the dashpot has
/// acted for theta + 1/2 of a step: the weight is (theta + 1/2)^(1 + q)/((1 + q) theta^q), its powers by a Pade
/// approximant. Without it the restitution of a linear impact of e = 0.5 scatters by 8 % at 10 steps, with the time of
/// first touch.
template <class Real>
EPAFI_LANES Real begun_share(const Real& overlap, const Real& moved, const Real& growth) {
  const Real one = Real{} + 1.0, least = Real{} + 1e-300;
  const Real way = max((1.0 + 1e-6) * moved, least);
  if (!any_less(overlap, way)) return one;
  const Real twice = 2.0 * max(overlap, Real{}), passed = 0.5 * (twice + way), q = min(growth, one);
  const Real turned = q * (passed - twice), mean = 1.0 - 0.25 * q * (1.0 - q);
  const Real power = mean * (passed + twice + turned) / max(passed + twice - turned, 0.01 * passed);
  const Real began = if_less(1e-6 * way, overlap, if_less(overlap, way, passed / way * power, one), Real{});
  return if_less(Real{}, overlap, began, one);
}

/// What a dashpot loses.
template <class Real>
struct DashpotLoss {
  Real power{};  ///< D v_middle of the force now, to be summed over steps by the trapezoidal rule [W]
  Real late{};   ///< what the previous force lost beyond that [J]
};

/// Loss of a dashpot with force D_n such that its sum over steps is the work of D along the bodies' motion: the sum of
/// D_n v_n with v_n = v_middle + dt/2 a_n, the velocity at the end of step n. The acceleration a_n, of all contacts, is
/// known only in the next step, as (v_late - v_middle) 2/dt: that part comes late, by the force of the step before,
/// which contacts remember. With the predicted velocity instead, energy errors would be 5e-3 for a loaded column of
/// four and 4e-2 for a single impact at e = 0.1.
template <class Real>
EPAFI_LANES DashpotLoss<Real> dashpot_loss(const DamperStep<Real>& step, const Real& push, const Real& push_before,
                                           const Real& v_late, const Real& v_middle) {
  const double r = step.before;
  // a run begins with half a step of the first force, which acts on the mean velocity of that half
  const double share = r > 0.0 ? r : 0.5;
  return {push * v_middle, 0.5 * (1.0 + r) * step.dt * (push_before * (share * (v_late - v_middle)))};
}

/// dt^2/4 k plus the dashpot's part for a force that alternates from step to step [kg]. A body is stable while the sum
/// over its contacts is below its mass: exactly with the dashpot of damper_in_step, on the safe side with the law's
/// own, by up to 1.4 of the step at e = 0.1. mobility: 1/m* [1/kg].
inline double damped_weight(double stiffness, double dashpot, double mobility, double dt) {
  const double spring = 0.25 * dt * dt * stiffness, damper = dt * dashpot;
  return spring + damper * std::max(0.0, 1.0 - spring * mobility) / (1.0 + 0.5 * damper_share * damper * mobility);
}

/// The same for a single contact, for which another root is critical; up to 10 % on the safe side, from e = 0.4 to
/// overdamped.
inline double lone_damped_weight(double stiffness, double dashpot, double mobility, double dt) {
  const double other = 0.25 * dt * dt * stiffness + dt * dashpot / damper_share;
  return std::max(damped_weight(stiffness, dashpot, mobility, dt), other);
}

}  // namespace epafi
