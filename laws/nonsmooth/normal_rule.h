/// @file normal_rule.h  The local rule of a frictionless contact: r_N = max(0, r_N - u_N / W_NN), four at a time.
#pragma once
#include "engine/lanes/lanes.h"
#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

struct NormalRule {
  static constexpr int rows = 1;
  struct LaneData {
    Lanes step;  ///< 1/W_NN, 0 where nothing moves
  };
  static void pack(const ContactProblem& problem, std::size_t i, LaneData& data, std::size_t lane) {
    data.step[lane] = problem.mobility[i] > 0.0 ? 1.0 / problem.mobility[i] : 0.0;
  }
  EPAFI_LANES void update(const LaneData& d, Lanes, Lanes (&r)[1], const Lanes (&u)[1]) const {
    r[0] = max(Lanes{}, r[0] - d.step * u[0]);
  }
};

}  // namespace epafi
