/// @file shared_sweeps.h  Sweeps of pgs by several processes: each has the pairs of a run of slots, as many contacts as
/// the others. Colours are those of the whole problem; after each of them the velocities of bodies that others sweep
/// too go to these, and norms are order-free sums over all. So impulses and number of sweeps are those of one process,
/// to the bit. Per colour and sweep a message to each neighbour: below RankMessages::least_contacts it is not worth it.
#pragma once
#include <optional>

#include "engine/ranks/rank_messages.h"
#include "laws/nonsmooth/contact_problem.h"
#include "laws/nonsmooth/sweep_until.h"

namespace epafi {

struct SweepStart {
  double rho = 1.0, scale = 1.0;  ///< as GaussSeidel::solve has them
  double norm = 0.0;              ///< ||r|| at the start
  double relaxation = 1.0;
  SweepLimits limits;
};

/// By process 0, whose problem it is, with v, the velocities of r. Nothing where no others wait for work, or where some
/// pairs have no colour of their own.
std::optional<SolverReport> share_sweeps(const ContactProblem& problem, const SweepStart& start,
                                         const BodyVelocities& v, Impulses& r);
/// The same with these others, whatever the size.
std::optional<SolverReport> share_sweeps(RankMessages& messages, const ContactProblem& problem, const SweepStart& start,
                                         const BodyVelocities& v, Impulses& r);
/// By all others meanwhile.
void help_with_sweeps(RankMessages& messages);

}  // namespace epafi
