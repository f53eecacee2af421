/// @file gauss_seidel.h  The sweeps of a Gauss-Seidel solver and when to stop them. Cheap test after every sweep: the
/// change of r in the sweep, scaled like the residual. When it falls below the tolerance the true residual decides; if
/// it is not met the cheap threshold is lowered in proportion (Acary, Bremond and Huber 2018). Cost: linear in contacts
/// per sweep. On n stacked boxes 0.93 n^2 sweeps per decade, on mass ratio q about 2.3 q: the fast end of the chart for
/// loose systems, not for tall stacks or heavy bodies on light ones.
#pragma once
#include <cmath>

#include "engine/threads/order_free_sum.h"
#include "laws/nonsmooth/cone_sweep.h"
#include "laws/nonsmooth/lane_sweep.h"
#include "laws/nonsmooth/residual.h"
#include "laws/nonsmooth/shared_sweeps.h"
#include "laws/nonsmooth/solvers/pgs.h"
#include "laws/nonsmooth/solvers/solver.h"
#include "laws/nonsmooth/sweep.h"

namespace epafi {

namespace gauss_seidel_detail {
/// Four contacts at a time where the rule can.
template <bool Rotates, class Rule>
struct Chosen {
  using type = Sweep<Rotates, Rule>;
};
template <bool Rotates, LaneRule Rule>
struct Chosen<Rotates, Rule> {
  using type = LaneSweep<Rotates, Rule>;
};
}  // namespace gauss_seidel_detail
template <bool Rotates, class Rule>
using SweepOf = typename gauss_seidel_detail::Chosen<Rotates, Rule>::type;

template <LocalRule Rule>
class GaussSeidel final : public ContactSolver {
 public:
  GaussSeidel(Rule rule, const Parameters& parameters)
      : rule_(rule),
        iterations_(static_cast<int>(parameters.number_or("iterations", 50))),
        tolerance_(parameters.number_or("tolerance", 1e-6)) {}

  SolverReport solve(const ContactProblem& problem, Impulses& r) override {
    const double rho = problem.mean_effective_mass(), scale = cheap_scale(problem, rho);
    problem.velocities(r, v_);
    if constexpr (std::is_same_v<Rule, PgsRule>)
      if (const auto shared = share_sweeps(problem, {rho, scale, norm(r), rule_.relaxation, limits()}, v_, r))
        return *shared;
    const auto with = [&](auto& sweep) {
      sweep.load(problem, r, v_);
      const auto measure = [&] {
        if constexpr (requires { sweep.natural_map(rho); }) {
          return sweep.natural_map(rho) / scale;
        } else {
          sweep.store(r);
          return measure_residual(problem, r, rho, v_, u_).value;
        }
      };
      const SolverReport report = iterate(
          scale, r, [&](int) { return sweep.run(rule_); }, measure);
      sweep.store(r);
      return report;
    };
    return problem.rotates ? with(with_rotation_) : with(without_rotation_);
  }

  SolverReport solve(const ConeProblem& problem, Impulses& r) override {
    blocks_.load(problem);
    blocks_.start(r);
    const auto measure = [&] {
      problem.relative_velocities(r, block_v_, u_);
      return problem.residual(r, u_);
    };
    return iterate(
        problem.scale * problem.q_norm(), r, [&](int) { return blocks_.run(rule_, r); }, measure);
  }

 private:
  SweepLimits limits() const { return {iterations_, tolerance_}; }

  template <class Run, class Measure>
  SolverReport iterate(double scale, const Impulses& r, const Run& sweep, const Measure& measure) {
    return sweep_until(
        limits(), scale, sweep, measure, [&] { return norm(r); }, [&] { return stop(); });
  }

  static double norm(const Impulses& r) {
    return std::sqrt(order_free_sum(r.size(), [&](std::size_t i) { return r[i].squaredNorm(); }));
  }

  /// rho ||q||, or rho where q = 0.
  double cheap_scale(const ContactProblem& problem, double rho) const {
    const double q2 =
        order_free_sum(problem.size(), [&](std::size_t i) { return problem.free_relative_velocity(i).squaredNorm(); });
    return rho * (q2 > 0.0 ? std::sqrt(q2) : 1.0);
  }

  Rule rule_;
  int iterations_;
  double tolerance_;
  SweepOf<true, Rule> with_rotation_;
  SweepOf<false, Rule> without_rotation_;
  BodyVelocities v_;
  std::vector<Vec3> u_;
  ConeSweep<Rule> blocks_;
  std::vector<Vec6> block_v_;
};

}  // namespace epafi
