/// @file smooth_surface.h  Surfaces by an implicit function F(x) = 0, F > 0 outside, with first and second derivatives:
/// all that curvature and nearest points need. Body axes.
#pragma once
#include <cmath>

#include "detection/shapes/ellipsoid.h"
#include "detection/shapes/half_space.h"
#include "detection/shapes/sphere.h"
#include "engine/state/types.h"

namespace epafi {

/// F and its derivatives at a point. The gradient must not vanish on the evaluated part.
struct ImplicitValue {
  double value = 0.0;
  Vec3 gradient = Vec3::Zero();
  Mat3 hessian = Mat3::Zero();
};

/// Behind one function pointer, so that the solver is compiled once.
struct SmoothSurface {
  const void* shape = nullptr;
  ImplicitValue (*value_of)(const void*, const Vec3&) = nullptr;
  double size = 1.0;  ///< reference of tolerances [m]
  ImplicitValue operator()(const Vec3& x) const { return value_of(shape, x); }
};

/// Cylinder about the z axis without ends, radius [m] > 0.
struct CylinderSide {
  double radius;
};
/// Ring about the z axis: all points at `tube` from a circle of radius `ring` [m], 0 < tube < ring.
struct Torus {
  double ring, tube;
};

inline ImplicitValue implicit_value(const Sphere& s, const Vec3& x) {
  return {0.5 * (x.squaredNorm() - s.radius * s.radius), x, Mat3::Identity()};
}
inline ImplicitValue implicit_value(const HalfSpace& h, const Vec3& x) {
  return {h.normal.dot(x), h.normal, Mat3::Zero()};
}
inline ImplicitValue implicit_value(const CylinderSide& c, const Vec3& x) {
  const Vec3 across(x.x(), x.y(), 0.0);
  return {0.5 * (across.squaredNorm() - c.radius * c.radius), across, Vec3(1, 1, 0).asDiagonal()};
}
inline ImplicitValue implicit_value(const Ellipsoid& e, const Vec3& x) {
  const double scale = e.semi_axes.minCoeff();  // so that F is about the distance times the size
  const Vec3 w = scale * scale * e.semi_axes.cwiseProduct(e.semi_axes).cwiseInverse();
  return {0.5 * (x.dot(w.cwiseProduct(x)) - scale * scale), w.cwiseProduct(x), Mat3(w.asDiagonal())};
}
/// F = (distance from the circle)^2 / 2 - tube^2 / 2; not smooth on the axis.
inline ImplicitValue implicit_value(const Torus& t, const Vec3& x) {
  const double rho = std::hypot(x.x(), x.y()), beyond = rho - t.ring;
  const Vec3 out(x.x() / rho, x.y() / rho, 0.0), round(-out.y(), out.x(), 0.0), z = Vec3::UnitZ();
  ImplicitValue v;
  v.value = 0.5 * (beyond * beyond + x.z() * x.z() - t.tube * t.tube);
  v.gradient = beyond * out + x.z() * z;
  v.hessian = out * out.transpose() + z * z.transpose() + beyond / rho * round * round.transpose();
  return v;
}

inline double surface_size(const Sphere& s) { return s.radius; }
inline double surface_size(const HalfSpace&) { return 0.0; }  // the other body's counts
inline double surface_size(const CylinderSide& c) { return c.radius; }
inline double surface_size(const Ellipsoid& e) { return e.semi_axes.maxCoeff(); }
inline double surface_size(const Torus& t) { return t.ring + t.tube; }

template <class S>
SmoothSurface smooth_surface(const S& shape) {
  return {&shape, [](const void* p, const Vec3& x) { return implicit_value(*static_cast<const S*>(p), x); },
          surface_size(shape)};
}

}  // namespace epafi
