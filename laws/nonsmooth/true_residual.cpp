#include "laws/nonsmooth/true_residual.h"

#include <cmath>

#include "laws/factors.h"
#include "laws/nonsmooth/twofold.h"

namespace epafi {

namespace {

template <std::size_t N>
using Precise = std::array<Twofold, N>;

/// M v = f of one body, by doubles and three corrections by what is left.
Precise<6> solve_body(const Mat6& mass, const Precise<6>& f) {
  Precise<6> v{}, rest = f;
  for (int round = 0; round < 4; ++round) {
    Vec6 right;
    for (int k = 0; k < 6; ++k) right(k) = rest[static_cast<std::size_t>(k)].value();
    const Vec6 change = solve_llt(mass, right);
    for (std::size_t k = 0; k < 6; ++k) v[k] += change(static_cast<int>(k));
    rest = f;
    for (std::size_t k = 0; k < 6; ++k)
      for (std::size_t j = 0; j < 6; ++j) rest[k] += v[j] * -mass(static_cast<int>(k), static_cast<int>(j));
  }
  return v;
}

std::vector<Precise<6>> body_velocities(const ConeProblem& p, const Impulses& r) {
  std::vector<Precise<6>> v(p.bodies());
  for (std::size_t i = 0; i < p.rows.size(); ++i)
    for (std::size_t s = 0; s < 2; ++s) {
      if (p.rows[i].body[s] == ConeProblem::no_body) continue;
      Precise<6>& of = v[p.rows[i].body[s]];
      for (int k = 0; k < 6; ++k)
        for (int c = 0; c < 3; ++c)
          of[static_cast<std::size_t>(k)] += Twofold::product(p.rows[i].jacobian[s](k, c), r[i](c));
    }
  for (std::size_t b = 0; b < v.size(); ++b) v[b] = solve_body(p.mass[b], v[b]);
  return v;
}

/// W r + q of contact i; v: of the bodies, in the body form.
Precise<3> relative_velocity(const ConeProblem& p, std::size_t i, const Impulses& r, const std::vector<Precise<6>>& v) {
  Precise<3> u{p.q[i].x(), p.q[i].y(), p.q[i].z()};
  if (p.has_bodies()) {
    for (std::size_t s = 0; s < 2; ++s) {
      if (p.rows[i].body[s] == ConeProblem::no_body) continue;
      const Precise<6>& of = v[p.rows[i].body[s]];
      for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 6; ++k)
          u[static_cast<std::size_t>(c)] += of[static_cast<std::size_t>(k)] * p.rows[i].jacobian[s](k, c);
    }
  } else if (!p.begin.empty()) {
    for (std::size_t b = p.begin[i]; b < p.begin[i + 1]; ++b)
      for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k)
          u[static_cast<std::size_t>(c)] += Twofold::product(p.block[b](c, k), r[p.column[b]](k));
  }
  return u;
}

Twofold tangential(const Precise<3>& x) { return sqrt(x[1] * x[1] + x[2] * x[2]); }

/// project_cone of cone.h.
Precise<3> project(const Precise<3>& x, double mu) {
  const Twofold t = tangential(x);
  if (Twofold(0.0) <= x[0] && t <= x[0] * mu) return x;
  if (t * mu <= -x[0]) return {};
  const Twofold normal = (x[0] + t * mu) / (Twofold(1.0) + Twofold::product(mu, mu));
  if (!(Twofold(0.0) < t)) return {normal, {}, {}};
  const Twofold scale = normal * mu / t;
  return {normal, scale * x[1], scale * x[2]};
}

/// natural_map of cone.h, squared.
double natural_square(const Vec3& r, const Precise<3>& u, double mu, double rho) {
  const Precise<3> push{u[0] + tangential(u) * mu, u[1], u[2]};
  Precise<3> x;
  for (std::size_t k = 0; k < 3; ++k) x[k] = Twofold(r(static_cast<int>(k))) - push[k] * rho;
  const Precise<3> foot = project(x, mu);
  double sum = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double part = (Twofold(r(static_cast<int>(k))) - foot[k]).value();
    sum += part * part;
  }
  return sum;
}

}  // namespace

TrueResidual true_residual(const ConeProblem& p, const Impulses& r) {
  std::vector<Precise<6>> v;
  if (p.has_bodies()) v = body_velocities(p, r);
  double sum = 0.0, worst = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Precise<3> u = relative_velocity(p, i, r, v);
    sum += natural_square(r[i], u, p.friction[i], p.scale);
    if (!(-u[0].value() <= worst) && !std::isnan(worst)) worst = -u[0].value();
    largest = std::max(largest, p.q[i].norm());
  }
  return {std::sqrt(sum) / (p.scale * p.q_norm()), largest > 0.0 ? worst / largest : worst};
}

}  // namespace epafi
