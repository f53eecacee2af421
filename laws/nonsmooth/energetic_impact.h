/// @file energetic_impact.h  An eccentric impact with friction at one contact, by the energetic coefficient of
/// restitution (Stronge 1990; 2000, ch. 3 and 4; in space Batlle 1996). With the normal impulse p as time,
///   du/dp = W (n + f),   f = -mu u_T/|u_T| while sliding, else the force that keeps it sticking, |f| <= mu,
/// compression lasts until u_N = 0, and expansion until the normal impulse has returned e^2 of the work of compression:
///   int_0^p u_N dp = (1 - e^2) int_0^pc u_N dp.
/// Friction always dissipates, and the normal impulse loses the share 1 - e^2: no gain for e in [0, 1] (Newton's and
/// Poisson's laws can gain energy if the slip reverses within the impact). Without friction, or if W_TN = 0: u_N+ =
/// -e u_N-. Sliding in a changing direction is integrated by Runge-Kutta steps of 4th order, relative error below 1e-7;
/// straight sliding and sticking have closed forms.
#pragma once
#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

/// The impulse in the frame (n, t1, t2) [N s]. w: W_ii [1/kg], positive definite; u: velocity of B against A, u_N < 0
/// [m/s].
Vec3 energetic_impulse(const Mat3& w, double mu, double restitution, const Vec3& u);

/// True if impact laws can differ: there is friction, and a normal impulse changes the slip.
bool is_eccentric(const Mat3& w, double mu);

}  // namespace epafi
