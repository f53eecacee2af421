#include "laws/nonsmooth/residual.h"

#include <algorithm>

#include "engine/error.h"
#include "engine/parallel.h"
#include "laws/nonsmooth/cone.h"

namespace epafi {

namespace {

struct Norms {
  double map2 = 0.0, q2 = 0.0;           // sums of squares
  double penetration = 0.0, q_max2 = 0.0;  // maxima
  Norms& operator+=(const Norms& o) {
    map2 += o.map2, q2 += o.q2;
    penetration = std::max(penetration, o.penetration), q_max2 = std::max(q_max2, o.q_max2);
    return *this;
  }
};

}  // namespace

Residual measure_residual(const ContactProblem& problem, const Impulses& r, const std::vector<Vec3>& u, double rho) {
  EPAFI_REQUIRE(r.size() == problem.size() && u.size() == r.size(), "one impulse and one velocity per contact");
  const auto norms = block_sum<Norms>(problem.size(), [&](std::size_t i) {
    if (problem.diagonal[i](0, 0) <= 0.0) return Norms{};  // between two bodies that no impulse moves
    const double q2 = problem.free_relative_velocity(i).squaredNorm();
    return Norms{natural_map(r[i], u[i], problem.friction[i], rho).squaredNorm(), q2, -u[i].x(), q2};
  });
  const double scale = norms.q2 > 0.0 ? std::sqrt(norms.q2) : 1.0;
  const double q_max = norms.q_max2 > 0.0 ? std::sqrt(norms.q_max2) : 1.0;
  return {std::sqrt(norms.map2) / (rho * scale), norms.penetration / q_max};
}

Residual measure_residual(const ContactProblem& problem, const Impulses& r, double rho, BodyVelocities& v,
                          std::vector<Vec3>& u) {
  problem.velocities(r, v);
  problem.relative_velocities(v, u);
  return measure_residual(problem, r, u, rho);
}

}  // namespace epafi
