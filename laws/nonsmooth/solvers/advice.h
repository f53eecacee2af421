/// @file advice.h  Which solver would do where one stopped above its tolerance: tried on a step that it left.
#pragma once
#include <string>

#include "laws/nonsmooth/cone_problem.h"

namespace epafi {

/// "contact.nonsmooth.solver = newton solves such a step (residual 3e-8 after 9 iterations)". Tries those whose work is
/// below a second or two by count; says so where none of them does.
std::string solver_that_would_do(const ConeProblem& problem, double tolerance);

}  // namespace epafi
