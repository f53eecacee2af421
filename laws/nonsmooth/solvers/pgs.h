/// @file pgs.h  The local rule of projected Gauss-Seidel: the normal row, then both tangential rows on the exact disk.
/// r_N = max(0, r_N - omega u_N / W_NN), then r_T = P_disk(r_T - omega u_T / w_T) with the disk of the new mu r_N
/// (Jourdan, Alart and Jean 1998; Moreau's fixed point). w_T is the larger eigenvalue of W_TT: the step never
/// overshoots.
#pragma once
#include "engine/lanes/lanes.h"
#include "laws/nonsmooth/cone.h"
#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

struct PgsRule {
  double relaxation = 1.0;  ///< omega in (0, 2)

  struct Data {
    double step_n, step_t;        ///< 1/W_NN and 1/w_T [kg], 0 where nothing moves
    double coupling1, coupling2;  ///< W_TN: what a normal impulse does to u_T [1/kg]
  };
  static Data pack(const Mat3& w) {
    if (w(0, 0) <= 0.0) return {0, 0, 0, 0};
    const double half_difference = 0.5 * (w(1, 1) - w(2, 2));
    const double largest = 0.5 * (w(1, 1) + w(2, 2)) + std::sqrt(half_difference * half_difference + w(1, 2) * w(1, 2));
    return {1.0 / w(0, 0), 1.0 / largest, w(1, 0), w(2, 0)};
  }
  Vec3 update(const Data& d, double mu, const Vec3& r, const Vec3& u) const {
    const double normal = std::max(0.0, r.x() - relaxation * d.step_n * u.x());
    const double change = normal - r.x(), step = relaxation * d.step_t;
    const double t1 = r.y() - step * (u.y() + d.coupling1 * change), t2 = r.z() - step * (u.z() + d.coupling2 * change);
    return project_disk({normal, t1, t2}, mu * normal);
  }

  // the same for four contacts
  static constexpr int rows = 3;
  struct LaneData {
    Lanes step_n, step_t, coupling1, coupling2;
  };
  static void pack(const ContactProblem& problem, std::size_t i, LaneData& data, std::size_t lane) {
    const Data d = pack(problem.diagonal[i]);
    data.step_n[lane] = d.step_n;
    data.step_t[lane] = d.step_t;
    data.coupling1[lane] = d.coupling1;
    data.coupling2[lane] = d.coupling2;
  }
  EPAFI_LANES void update(const LaneData& d, Lanes mu, Lanes (&r)[3], const Lanes (&u)[3]) const {
    const Lanes normal = max(Lanes{}, r[0] - relaxation * d.step_n * u[0]);
    const Lanes change = normal - r[0], step = relaxation * d.step_t;
    const Lanes t1 = r[1] - step * (u[1] + d.coupling1 * change), t2 = r[2] - step * (u[2] + d.coupling2 * change);
    const Lanes radius = mu * normal, length2 = t1 * t1 + t2 * t2;
    const LaneMask slides = length2 > radius * radius;
    r[0] = normal;
    r[1] = t1;
    r[2] = t2;
    if (!any(slides)) return;
    const Lanes scale = select(slides, radius / sqrt(length2), lanes(1.0));
    r[1] = scale * t1;
    r[2] = scale * t2;
  }
};

}  // namespace epafi
