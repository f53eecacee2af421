#include "laws/nonsmooth/residual.h"

#include <algorithm>

#include "engine/threads/order_free_sum.h"
#include "engine/units/error.h"
#include "laws/nonsmooth/cone.h"

namespace epafi {

namespace {

/// Sum and largest of f(i) of the contacts that impulses move.
template <class F>
SumAndLargest sum_over_moved(const ContactProblem& problem, const F& f) {
  const auto term = [&](std::size_t i) { return std::array{problem.mobility[i] <= 0.0 ? 0.0 : f(i)}; };
  return order_free_sums<1>(problem.size(), term)[0];
}

}  // namespace

FreeMotion measure_free_motion(const ContactProblem& problem) {
  const SumAndLargest q =
      sum_over_moved(problem, [&](std::size_t i) { return problem.free_relative_velocity(i).squaredNorm(); });
  return {q.sum > 0.0 ? std::sqrt(q.sum) : 1.0, q.largest > 0.0 ? std::sqrt(q.largest) : 1.0};
}

Residual measure_residual(const ContactProblem& problem, const Impulses& r, const std::vector<Vec3>& u, double rho,
                          const FreeMotion& q) {
  EPAFI_REQUIRE(r.size() == problem.size() && u.size() == r.size(), "one impulse and one velocity per contact");
  const SumAndLargest map = sum_over_moved(
      problem, [&](std::size_t i) { return natural_map(r[i], u[i], problem.friction[i], rho).squaredNorm(); });
  const double closing = block_max<double>(problem.size(), 0.0,
                                           [&](std::size_t i) { return problem.mobility[i] <= 0.0 ? 0.0 : -u[i].x(); });
  return {std::sqrt(map.sum) / (rho * q.norm), closing / q.largest};
}

Residual measure_residual(const ContactProblem& problem, const Impulses& r, double rho, BodyVelocities& v,
                          std::vector<Vec3>& u) {
  problem.velocities(r, v);
  problem.relative_velocities(v, u);
  return measure_residual(problem, r, u, rho, measure_free_motion(problem));
}

}  // namespace epafi
