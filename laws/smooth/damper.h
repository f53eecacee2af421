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

/// Of a contact's force in the step, for the balance of energy.
template <class Real>
struct ContactChange {
  Real overlap{};    ///< now [m]
  Real force{};      ///< now [N]
  Real stiffness{};  ///< [N/m]
};

/// The velocity that the step ends with [m/s]: v_late with the contact's own change of force, which is all of it where
/// it has begun in this step. With v_late the dashpot's loss is booked too high by D^2 dt/(2 m*) dt at the start of
/// every impact: 1 to 3 % of the energy at ten steps per contact.
template <class Real>
EPAFI_LANES Real velocity_after(const DamperStep<Real>& step, const Real& v_late, const Real& v_middle,
                                const ContactChange<Real>& now) {
  const Real moved = step.dt * v_middle;
  const Real change = select(now.overlap > moved, now.stiffness * moved, now.force);
  return v_late - step.half_mobility * change;
}

/// dt^2/4 k and what the dashpot adds to it where the contact's force alternates from step to step [kg]: a body is
/// stable while the sum of its contacts stays below its mass. mobility: 1/m* [1/kg].
inline double damped_weight(double stiffness, double dashpot, double mobility, double dt) {
  const double spring = 0.25 * dt * dt * stiffness, damper = dt * dashpot;
  return spring + damper * std::max(0.0, 1.0 - spring * mobility) / (1.0 + 0.5 * damper_share * damper * mobility);
}

/// Of a contact alone, whose other root decides: to 10 % on the safe side, from e = 0.4 to overdamped.
inline double lone_damped_weight(double stiffness, double dashpot, double mobility, double dt) {
  const double other = 0.25 * dt * dt * stiffness + dt * dashpot / damper_share;
  return std::max(damped_weight(stiffness, dashpot, mobility, dt), other);
}

}  // namespace epafi
