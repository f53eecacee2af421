/// @file nonsmooth_contact.h  Signorini-Coulomb contact with Newton restitution in the Moreau-Jean step (theta = 1/2).
/// Positions are those of the middle of the step when the contacts are found; the impulses change v_k to v_{k+1}.
///
/// Gaps. The gap g is measured at the middle and is next measured at the next middle, dt * u_N later, as both half
/// drifts use v_{k+1}. The constraint of an open contact is therefore u_N >= -g/dt, which keeps the next measured gap
/// >= 0. It has an impulse only if it would otherwise close, it never pulls, and the gap at the end of the step, g +
/// dt/2 u_N, is >= 0 too. The constraint of an overlapping contact is u_N >= 0; overlap is corrected in positions, not
/// velocities (position_correction.h).
///
/// Rolling. The contact point of a body that rolls on an edge moves, so the prediction g + dt u_N has an error (-4 g
/// dt^2/2 per step for Euler's disk, which would lose its energy in 6 s at dt = 0.1 ms). The constraint of the next
/// step returns this error as velocity, limited to the speed of approach, so that r.(u_k + u_{k+1}) = 0 and no energy
/// is created. The slip velocity is reduced by half of the change that rotation of the geometry alone causes (without
/// this the centre of the disk drifts by 1 mm at 10 degrees). Both need warm_start, and contacts recognised by their
/// feature: matching the nearest point of a pair keeps a pile of 1000 stones vibrating at 0.3 mm/s.
///
/// Restitution. An approach faster than 2 |g| dt at the start of the step (v_k, before gravity acts) that would close
/// the contact is an impact: u_N >= -e u_N^-, in the middle of the step, with half of gravity before and half after it:
/// u_{k+1} = -e (u_k + a dt/2) + a dt/2. (With u^- = u_k each bounce is dt late: an error of 1 % for Zeno's ball, case
/// A22.) Slower approaches do not bounce, because gravity within a step is not resolved and sweeps leave velocities of
/// that order in a pile; a resting contact has u_k = 0 and cannot bounce for any e. A contact that an impact elsewhere
/// closes is excluded from the step and bounces in the next one, except a resting one: it opens no faster than 2 |g|
/// dt, and its gap is below what that speed closes in a step. A resting contact transmits the shock and carries load;
/// otherwise a stack would fall for a step. An open contact bounces in the step in which it would close, at gap > 0:
/// early by less than dt, without overlap, and without a change of energy if e = 1. This law alone can create energy in
/// frictional impacts with rotation (Kane's paradox, case A21); impact.h has the correction and the other impact laws.
///
/// Servo walls (engine/step/nonsmooth_servo.h) are bodies of the problem that move along one line. Impulses act on them
/// within the step, so a plate carries its load exactly, also on rigid bodies.
///
/// Energy. In the discrete theory dT = sum r.(u_k + u_{k+1})/2 + work of gravity exactly: the energy error is rounding,
/// except for the drift of rotating bodies with unequal moments. A contact that opens slowly and that gravity closes
/// within the step would gain r u_k / 2 if it stopped at u_N = 0. In steps with bounces its constraint is therefore u_N
/// >= -u_k, at any overlap: its gap returns to the initial one, and the next step stops it, at most dt/2 u_k deeper. In
/// other steps contacts are stopped at once: drops on stacks gain at most 1.3e-3 of what they dissipate, and the joints
/// of a falling arch have a solution in every step (else in four of five).
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "engine/step/nonsmooth_servo.h"
#include "engine/step/pipeline.h"
#include "laws/material.h"
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

struct NonsmoothSetup {
  std::string solver = "adaptive";
  Parameters parameters;  ///< fields of the solver's entry (solvers/solver.h); absent ones take their defaults
  MaterialTable materials;
};

/// Needs of non-smooth contact: memory for warm starts; slip velocity and rotation if some pair has friction. The plan
/// adds rotation for bodies other than spheres.
Needs nonsmooth_needs(const NonsmoothSetup& setup);

/// Throws SceneError for an unknown solver, with the available names.
std::unique_ptr<ContactModel> make_nonsmooth_contact(const NonsmoothSetup& setup);
/// The same with the caller's solver; setup.solver is ignored.
std::unique_ptr<ContactModel> make_nonsmooth_contact(const NonsmoothSetup& setup, const SolverEntry& solver);

/// Makes the servo wall an unknown of the problems of this non-smooth model. Needs a world with rotation.
void add_nonsmooth_servo(ContactModel& model, std::shared_ptr<NonsmoothServo> wall);

/// The problem that a non-smooth contact model solved in the last step; null for other models.
const ContactProblem* last_problem(const ContactModel& model);
/// Advice after a run with steps above the tolerance: which solver reaches it. Empty if there was no such step, or if
/// its problem was too large to keep.
std::string solver_advice(const ContactModel& model);
/// Residual of each contact of the last step; the squares sum to the square of the total. Empty for other models.
std::vector<float> contact_residuals(const ContactModel& model);
/// Impacts so far under the law `poisson` or `sequential` (impact.h); 0 for other laws and models.
std::uint64_t impact_count(const ContactModel& model);

}  // namespace epafi
