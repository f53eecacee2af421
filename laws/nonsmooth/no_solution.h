/// @file no_solution.h  Detects problems without solution, and gives the reason. u = W r + q with r and u~ in their
/// cones is solvable if and only if some velocity opens all contacts (Acary and Cadoux 2013); only normal rows matter.
/// No velocity does if there are impulses d >= 0 that move nothing and against which all contacts close (Farkas 1902):
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

/// Examines contacts that impulses cannot open, and at most `most` contacts around the one that closes fastest. u:
/// relative velocities from a solver [m/s]. Returns nothing if these have a solution; others may still have none.
std::optional<NoSolution> find_no_solution(const ConeProblem& problem, const std::vector<Vec3>& u,
                                           std::size_t most = 64);

/// True if impulses are so large that rounding errors of W r exceed `share` of q: no residual is meaningful then.
bool beyond_measure(const ConeProblem& problem, const Impulses& r, double share);

}  // namespace epafi
