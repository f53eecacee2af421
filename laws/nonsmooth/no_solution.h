/// @file no_solution.h  Why a problem has no solution, where it has none. u = W r + q with r and u~ in their cones is
/// solvable if and only if some velocity opens all contacts (Acary and Cadoux 2013): its normal rows alone decide. None
/// does if there are impulses d >= 0 that move nothing and that all contacts would have to work against (Farkas 1902):
///   W_NN d = 0,   q_N . d < 0:   a ray along which every method runs off; of a body between two driven walls d = (1,
///   1).
/// One contact whose row and column of W are zero while q_N < 0 is the simplest one. Found as the least d >= 0 of
/// |W^(1/2) d|^2 + (q_N . d + 1)^2 (Lawson and Hanson 1974, ch. 23), which is 0 there and nowhere else.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "laws/nonsmooth/cone_problem.h"

namespace epafi {

struct NoSolution {
  bool zero_row = false;                ///< of one contact
  std::vector<std::uint32_t> contacts;  ///< those that no velocity opens together
  double closing = 0.0;                 ///< -q_N . d over the largest d [m/s]: how fast they close at least
  std::string text() const;             ///< "ray: contacts 1 and 2 close with 0.5 m/s whatever moves"
};

/// Looks at the contacts that impulses cannot open and at most `most` of those around the contact that closes fastest;
/// u: velocities that a solver came to. Nothing where these have a solution: others may have none then.
std::optional<NoSolution> find_no_solution(const ConeProblem& problem, const std::vector<Vec3>& u,
                                           std::size_t most = 64);

/// Impulses so large that the rounding of W r is more than `share` of q: then no residual means anything.
bool beyond_measure(const ConeProblem& problem, const Impulses& r, double share);

}  // namespace epafi
