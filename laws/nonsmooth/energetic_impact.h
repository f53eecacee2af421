/// @file energetic_impact.h  One contact with friction struck off the line of centres, by the energetic coefficient of
/// restitution (Stronge 1990; 2000, ch. 3 and 4; in space Batlle 1996): over the normal impulse p as time,
///   du/dp = W (n + f),   f = -mu u_T/|u_T| while it slides, else what keeps it stuck, |f| <= mu,
/// the contact is compressed until u_N = 0 and opens until the normal impulse has given back e^2 of the work it took:
///   int_0^p u_N dp = (1 - e^2) int_0^pc u_N dp.
/// Friction takes energy all the way and the normal impulse the share 1 - e^2: no gain for e in [0, 1] (Newton's and
/// Poisson's laws do gain, where the slip turns round within the impact). Without friction, or where W_TN = 0: u_N+ =
/// -e u_N-. Sliding along a bent hodograph is integrated by Runge-Kutta steps of 4th order, relative error below 1e-7;
/// straight sliding and sticking are closed forms.
#pragma once
#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

/// The impulse in the frame (n, t1, t2) [N s]. w: W_ii [1/kg], positive definite; u: velocity of B against A, u_N < 0
/// [m/s].
Vec3 energetic_impulse(const Mat3& w, double mu, double restitution, const Vec3& u);

/// The laws of impact can differ there: friction acts and a normal impulse changes the slip.
bool is_eccentric(const Mat3& w, double mu);

}  // namespace epafi
