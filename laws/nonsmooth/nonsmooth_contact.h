/// @file nonsmooth_contact.h  Signorini-Coulomb contact with Newton restitution in the Moreau-Jean step (theta = 1/2).
/// Positions are those of the middle of the step when the contacts are found; the impulses change v_k to v_{k+1}.
///
/// Gaps. The gap g is measured at the middle and is next measured at the next middle, dt * u_N later, as both half
/// drifts use v_{k+1}. An open contact therefore demands u_N >= -g/dt: exactly what keeps the next measured gap >= 0.
/// It carries an impulse only if it would otherwise close, it never pulls, and the gap at the end of the step, g + dt/2
/// u_N, is >= 0 too. An overlapping contact demands u_N >= 0; overlap is taken out by positions, not by velocities
/// (position_correction.h).
///
/// Rolling. A body that rolls on an edge comes down beside the contact point: the linear foresight g + dt u_N misses
/// -4 g dt^2/2 a step for Euler's disk, and stopping the new point each time took its energy in 6 s at dt = 0.1 ms.
/// What was missed is given back as velocity in the next step, not faster than the point approaches, so that r.(u_k +
/// u_{k+1}) = 0 and no energy is made. Slip likewise: half of what the turning geometry alone changed of u_T since the
/// last step is taken off it (without, the centre of the disk strayed by 1 mm at 10 degrees). Needs warm_start, and
/// only points found again by their name: one taken as the nearest of its pair kept a pile of 1000 stones trembling at
/// 0.3 mm/s.
///
/// Restitution. An approach faster than 2 |g| dt at the start of the step (v_k, before gravity acts in it) that would
/// close the contact is an impact: u_N >= -e u_N^- with half of the step's gravity before it and half after, as if it
/// happened at the middle: u_{k+1} = -e (u_k + a dt/2) + a dt/2. (With u^- = u_k each bounce came out dt late: Zeno's
/// ball by 1 %, case A22.) Slower approaches do not bounce: one step of gravity is not resolved, and sweeps that stop
/// early leave velocities of that order in a pile; a resting contact has u_k = 0 and cannot bounce whatever e is. A
/// contact that an impact elsewhere closes is left out of the step and bounces in the next one, but for one that rests:
/// it has not opened faster than that, and its gap is within what that speed closes in a step. Such a contact passes
/// the shock on as one without a gap does, and it carries load: without it a stack would fall for a step. An open
/// contact bounces in the step in which it would close, at gap > 0: early by less than dt, without overlap, and without
/// a change of energy if e = 1. This law alone can create energy in frictional impacts with rotation (Kane's paradox,
/// case A21): what the default does about it, and other laws of impact, in impact.h.
///
/// Servo walls (engine/step/giving_wall.h) are bodies of the problem that move along one line. Impulses reach them
/// within the step, so a plate carries its load exactly, on rigid bodies too.
///
/// Energy. In the discrete theory dT = sum r.(u_k + u_{k+1})/2 + work of gravity exactly: the ledger closes to rounding
/// but for the drift of rotating unsymmetric bodies. A contact that opens slowly and is closed again by gravity within
/// the step would gain r u_k / 2 if it were stopped at u_N = 0. Where contacts bounce it demands u_N >= -u_k only,
/// however deep it overlaps: at the end of the step it is where it was at its start, and the next step stops it, at
/// most dt/2 u_k deeper. Where nothing bounces contacts are stopped at once: drops on stacks gain at most 1.3e-3 of
/// what they dissipate, and the joints of a falling arch have a solution in every step (else in four of five).
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "engine/step/giving_wall.h"
#include "engine/step/pipeline.h"
#include "laws/material.h"
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

struct NonsmoothSetup {
  std::string solver = "adaptive";
  Parameters parameters;  ///< fields of the solver's entry (solvers/solver.h); absent ones take their defaults
  MaterialTable materials;
};

/// What the engine must provide: memory for warm starts; slip velocity and rotation where some pair has friction.
/// Bodies that are no spheres need rotation by themselves; the plan adds that.
Needs nonsmooth_needs(const NonsmoothSetup& setup);

/// Throws SceneError for an unknown solver, naming those that exist.
std::unique_ptr<ContactModel> make_nonsmooth_contact(const NonsmoothSetup& setup);
/// With a solver of the caller's own; setup.solver is ignored.
std::unique_ptr<ContactModel> make_nonsmooth_contact(const NonsmoothSetup& setup, const SolverEntry& solver);

/// The wall becomes a body of the problems of this non-smooth model. Worlds with such walls rotate.
void add_giving_wall(ContactModel& model, std::shared_ptr<GivingWall> wall);

/// The problem that a non-smooth contact model solved in the last step; null for other models.
const ContactProblem* last_problem(const ContactModel& model);
/// For the end of a run in which steps were left above the tolerance: which solver would do. Empty where none was left,
/// or where the problem was too large to keep.
std::string solver_advice(const ContactModel& model);
/// Of each contact of the last step what it has of the residual: the squares add up to that of the whole. Empty for
/// other models.
std::vector<float> contact_residuals(const ContactModel& model);
/// Impacts so far under the law `poisson` or `sequential` (impact.h); 0 for other laws and models.
std::uint64_t impact_count(const ContactModel& model);

}  // namespace epafi
