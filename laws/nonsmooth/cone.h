/// @file cone.h  The sets of exact Coulomb friction, in the contact frame: component 0 is normal, 1 and 2 are
/// tangential. K_mu = {|r_T| <= mu r_N}; its dual K*_mu = {mu |u_T| <= u_N} (De Saxce and Feng 1998; Acary and
/// Brogliato 2008, ch. 3). A contact obeys Signorini and Coulomb exactly when r in K_mu, u~ in K*_mu and r.u~ = 0.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/state/types.h"

namespace epafi {

/// Length of the tangential part.
inline double tangential_norm(const Vec3& x) { return std::sqrt(x.y() * x.y() + x.z() * x.z()); }

/// Nearest point of K_mu; mu >= 0.
inline Vec3 project_cone(const Vec3& x, double mu) {
  const double t = tangential_norm(x);
  if (x.x() >= 0.0 && t <= mu * x.x()) return x;
  if (mu * t <= -x.x()) return Vec3::Zero();                 // x lies in the polar cone
  const double normal = (x.x() + mu * t) / (1.0 + mu * mu);  // foot on the generator nearest to x
  const double scale = mu * normal / std::max(t, 1e-300);    // t = 0 comes here with mu = 0 only
  return {normal, scale * x.y(), scale * x.z()};
}

/// Nearest point of K*_mu, by Moreau's decomposition x = P_K*(x) - P_K(-x).
inline Vec3 project_dual_cone(const Vec3& x, double mu) { return x + project_cone(-x, mu); }

/// An element of the generalised derivative of project_cone at x: the identity inside K, 0 inside the polar cone,
/// between them the generator g = (1, mu e), e = x_T / |x_T|, and the turn of the foot about the axis.
inline Mat3 project_cone_derivative(const Vec3& x, double mu) {
  const double t = tangential_norm(x);
  if (x.x() >= 0.0 && t <= mu * x.x()) return Mat3::Identity();
  if (mu * t <= -x.x()) return Mat3::Zero();
  const double e1 = t > 0.0 ? x.y() / t : 0.0, e2 = t > 0.0 ? x.z() / t : 0.0;
  const Vec3 g(1.0, mu * e1, mu * e2), turn(0.0, -e2, e1);
  const double radius = mu * (x.x() + mu * t) / (1.0 + mu * mu);  // of the cone at the foot, < t
  const Mat3 generator = g * g.transpose() / (1.0 + mu * mu);
  return t > 0.0 ? Mat3(generator + (radius / t) * turn * turn.transpose()) : generator;
}

/// The tangential part moved to the disk of the given radius >= 0, along the ray to its centre; the normal part stays.
inline Vec3 project_disk(const Vec3& x, double radius) {
  const double t2 = x.y() * x.y() + x.z() * x.z();
  if (t2 <= radius * radius) return x;
  const double scale = radius / std::sqrt(t2);
  return {x.x(), scale * x.y(), scale * x.z()};
}

/// r inside K_mu, off its surface by more than rounding: such a contact sticks.
inline bool sticks(const Vec3& r, double mu) { return tangential_norm(r) < (1.0 - 1e-9) * mu * r.x(); }

/// u~ = u + mu |u_T| n: with it exact Coulomb friction is a cone complementarity.
inline Vec3 de_saxce(const Vec3& u, double mu) { return {u.x() + mu * tangential_norm(u), u.y(), u.z()}; }

/// r - P_K(r - rho u~): zero exactly at a solution; rho > 0 [kg].
inline Vec3 natural_map(const Vec3& r, const Vec3& u, double mu, double rho) {
  return r - project_cone(r - rho * de_saxce(u, mu), mu);
}

}  // namespace epafi
