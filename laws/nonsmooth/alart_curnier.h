/// @file alart_curnier.h  The map of Alart and Curnier (1991) of one contact, whose fixed points are the solutions of
/// exact Coulomb friction: r_N = max(0, z_N - rho u_N), r_T = P_disk(mu r_N)(z_T - rho u_T), at z = r. (With the
/// projection on the cone and the De Saxce shift instead, piles take 1.4 times the Newton steps: its argument moves by
/// mu rho |du_T| along the normal.)
#pragma once
#include "laws/nonsmooth/cone.h"

namespace epafi {

inline Vec3 alart_curnier(const Vec3& z, const Vec3& u, double mu, double rho) {
  const Vec3 x = z - rho * u;
  const double normal = std::max(0.0, x.x());
  return project_disk({normal, x.y(), x.z()}, mu * normal);
}

/// Minus its derivative by u. Unsymmetric where the contact slides: the normal impulse moves the bound of the other.
inline Mat3 alart_curnier_slope(const Vec3& z, const Vec3& u, double mu, double rho) {
  const Vec3 x = z - rho * u;
  if (x.x() <= 0.0) return Mat3::Zero();
  const double t = tangential_norm(x), radius = mu * x.x();
  if (t <= radius) return rho * Mat3::Identity();
  const double e1 = x.y() / t, e2 = x.z() / t, turn = radius / t;
  Mat3 slope;
  slope << 1.0, 0.0, 0.0,                                //
      mu * e1, turn * (1.0 - e1 * e1), -turn * e1 * e2,  //
      mu * e2, -turn * e1 * e2, turn * (1.0 - e2 * e2);
  return rho * slope;
}

}  // namespace epafi
