#include "laws/nonsmooth/residual.h"

#include <algorithm>

#include "engine/error.h"
#include "engine/parallel.h"
#include "laws/nonsmooth/cone.h"

namespace epafi {

namespace {

/// A sum of squares and a maximum.
struct Norms {
  double squares = 0.0, most = 0.0;
  Norms& operator+=(const Norms& o) {
    squares += o.squares, most = std::max(most, o.most);
    return *this;
  }
};

/// f(i) of the contacts that impulses move.
template <class F>
Norms norms_of(const ContactProblem& problem, const F& f) {
  return block_sum<Norms>(problem.size(), [&](std::size_t i) { return problem.mobility[i] <= 0.0 ? Norms{} : f(i); });
}

}  // namespace

FreeMotion measure_free_motion(const ContactProblem& problem) {
  const Norms q = norms_of(problem, [&](std::size_t i) {
    const double q2 = problem.free_relative_velocity(i).squaredNorm();
    return Norms{q2, q2};
  });
  return {q.squares > 0.0 ? std::sqrt(q.squares) : 1.0, q.most > 0.0 ? std::sqrt(q.most) : 1.0};
}

Residual measure_residual(const ContactProblem& problem, const Impulses& r, const std::vector<Vec3>& u, double rho,
                          const FreeMotion& q) {
  EPAFI_REQUIRE(r.size() == problem.size() && u.size() == r.size(), "one impulse and one velocity per contact");
  const Norms map = norms_of(problem, [&](std::size_t i) {
    return Norms{natural_map(r[i], u[i], problem.friction[i], rho).squaredNorm(), -u[i].x()};
  });
  return {std::sqrt(map.squares) / (rho * q.norm), map.most / q.largest};
}

Residual measure_residual(const ContactProblem& problem, const Impulses& r, double rho, BodyVelocities& v,
                          std::vector<Vec3>& u) {
  problem.velocities(r, v);
  problem.relative_velocities(v, u);
  return measure_residual(problem, r, u, rho, measure_free_motion(problem));
}

}  // namespace epafi
