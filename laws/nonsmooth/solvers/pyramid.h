/// @file pyramid.h  Projected Gauss-Seidel with the disk of Coulomb replaced by a regular polygon of m sides inside it:
/// the cone of m generators of linear complementarity methods (Stewart and Trinkle 1996). Relaxes Coulomb: the limit of
/// friction is mu r_N along a generator and mu r_N cos(pi/m) between two, so it depends on how the contact lies (4
/// sides: up to 29 % less, 16 sides: 2 %), and the force need not oppose the slip (up to pi/m off). The gap stays in
/// the residual, which is that of the exact cone.
#pragma once
#include <numbers>
#include <vector>

#include "laws/nonsmooth/solvers/pgs.h"

namespace epafi {

struct PyramidRule : PgsRule {
  std::vector<Eigen::Vector2d> corners;  ///< of the polygon of radius 1, the first along the first tangent

  PyramidRule(double omega, int sides) : PgsRule{omega} {
    const double step = 2.0 * std::numbers::pi / sides;
    for (int k = 0; k < sides; ++k) corners.emplace_back(std::cos(k * step), std::sin(k * step));
  }

  Vec3 update(const Data& d, double mu, const Vec3& r, const Vec3& u) const {
    const double normal = std::max(0.0, r.x() - relaxation * d.step_n * u.x());
    const double change = normal - r.x(), step = relaxation * d.step_t;
    const Eigen::Vector2d wish(r.y() - step * (u.y() + d.coupling1 * change),
                               r.z() - step * (u.z() + d.coupling2 * change));
    const Eigen::Vector2d t = nearest(wish, mu * normal);
    return {normal, t.x(), t.y()};
  }

  /// Nearest point of the polygon of the given radius >= 0.
  Eigen::Vector2d nearest(const Eigen::Vector2d& x, double radius) const {
    double farthest = 0.0;
    Eigen::Vector2d best = x;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Eigen::Vector2d &from = corners[k], &to = corners[(k + 1) % corners.size()];
      const Eigen::Vector2d along = to - from, out = Eigen::Vector2d(along.y(), -along.x()).normalized();
      const double beyond = out.dot(x - radius * from);
      if (!(beyond > farthest)) continue;
      farthest = beyond;
      const double share = radius > 0.0 ? (x - radius * from).dot(along) / (radius * along.squaredNorm()) : 0.0;
      best = radius * (from + std::clamp(share, 0.0, 1.0) * along);
    }
    return best;
  }
};

}  // namespace epafi
