#include "detection/surfaces/hertzian.h"

#include <algorithm>

#include "engine/state/frame.h"

namespace epafi {
namespace {

using Tangents = Eigen::Matrix<double, 3, 2>;
using Mat2 = Eigen::Matrix2d;

Tangents tangents_of(const Vec3& n) {
  const ContactFrame frame = contact_frame(n);
  Tangents t;
  t << frame.tangent1, frame.tangent2;
  return t;
}

/// Of a symmetric 2 x 2 form over a tangent plane.
PrincipalCurvatures principal(const Mat2& form, const Tangents& t, const Vec3& normal) {
  const double mean = 0.5 * (form(0, 0) + form(1, 1)), difference = 0.5 * (form(0, 0) - form(1, 1));
  const double shear = 0.5 * (form(0, 1) + form(1, 0)), radius = std::hypot(difference, shear);
  const double angle = radius > 0.0 ? 0.5 * std::atan2(shear, difference) : 0.0;
  PrincipalCurvatures p;
  p.larger = mean + radius;
  p.smaller = mean - radius;
  p.direction_larger = std::cos(angle) * t.col(0) + std::sin(angle) * t.col(1);
  p.direction_smaller = normal.cross(p.direction_larger);
  return p;
}

/// A surface in A's position and world axes, at one point.
struct Local {
  ImplicitValue f;
  Vec3 normal;
  Mat3 turning;  ///< d normal / d x
};

Local look(const SmoothSurface& s, const Mat3& to_world, const Vec3& x) {
  Local l{s(to_world.transpose() * x), {}, {}};
  l.f.gradient = to_world * l.f.gradient;
  l.f.hessian = to_world * l.f.hessian * to_world.transpose();
  const double slope = l.f.gradient.norm();
  l.normal = l.f.gradient / slope;
  l.turning = (Mat3::Identity() - l.normal * l.normal.transpose()) * l.f.hessian / slope;
  return l;
}

/// Foot of x on the surface along gradients: Newton's method in one dimension at a time.
Vec3 foot(const SmoothSurface& s, const Mat3& to_world, Vec3 x) {
  for (int k = 0; k < 40; ++k) {
    const ImplicitValue f = s(to_world.transpose() * x);
    const double slope = f.gradient.squaredNorm();
    if (!(slope > 0.0)) break;
    const Vec3 step = f.value / slope * (to_world * f.gradient);
    x -= step;
    if (step.norm() < 1e-15 * s.size) break;
  }
  return x;
}

Mat2 form_of(const Local& l, const Tangents& t) { return t.transpose() * l.turning * t; }

}  // namespace

PrincipalCurvatures principal_curvatures(const ImplicitValue& f) {
  const double slope = f.gradient.norm();
  const Vec3 n = f.gradient / slope;
  const Tangents t = tangents_of(n);
  return principal(t.transpose() * f.hessian * t / slope, t, n);
}

namespace {

/// Both surfaces at the ends of a common normal to be: x on A, x + gap n_a(x) on B.
struct State {
  Vec3 x;
  double gap;
  Local a, b;
  /// Squares of what must vanish; normals that look the same way count most.
  double merit(double size) const {
    const double on_a = a.f.value / (a.f.gradient.norm() * size), on_b = b.f.value / (b.f.gradient.norm() * size);
    return on_a * on_a + on_b * on_b + (a.normal + b.normal).squaredNorm();
  }
};

struct Surfaces {
  const SmoothSurface &a, &b;
  Mat3 turn_a, turn_b;
  Vec3 between;  ///< from A's position to B's, world axes
  State at(const Vec3& x, double gap) const {
    State s{x, gap, look(a, turn_a, x), {}};
    s.b = look(b, turn_b, x + gap * s.a.normal - between);
    return s;
  }
};

Eigen::Vector4d newton_step(const State& s) {
  const Tangents t = tangents_of(s.a.normal);
  const Mat3 carried = Mat3::Identity() + s.gap * s.a.turning;  // d x_b / d x_a
  Eigen::Matrix4d jacobian;
  Eigen::Vector4d rest;
  jacobian.row(0) << s.a.f.gradient.transpose(), 0.0;
  jacobian.row(1) << s.b.f.gradient.transpose() * carried, s.b.f.gradient.dot(s.a.normal);
  jacobian.bottomRows<2>() << t.transpose() * (s.b.turning * carried + s.a.turning),
      t.transpose() * s.b.turning * s.a.normal;
  rest << s.a.f.value, s.b.f.value, t.transpose() * (s.a.normal + s.b.normal);
  return jacobian.fullPivLu().solve(rest);
}

HertzianPoints describe(const State& s, const Vec3& between, double size) {
  HertzianPoints out;
  const Tangents t = tangents_of(s.a.normal);
  const Mat2 form_a = form_of(s.a, t), form_b = form_of(s.b, t);
  out.gap = s.gap;
  out.normal = s.a.normal;
  out.point_a = s.x;
  out.point_b = s.x + s.gap * s.a.normal - between;
  out.a = principal(form_a, t, s.a.normal);
  out.b = principal(form_b, t, s.b.normal);
  out.relative = principal(form_a + form_b, t, s.a.normal);
  // The distance is smallest where B touches the surface parallel to A at that distance from outside: the curvature of
  // the parallel surface, S (1 + gap S)^-1, and that of B open a gap on all sides.
  const Mat2 carried = Mat2::Identity() + s.gap * form_a;
  const PrincipalCurvatures opening = principal(carried.inverse() * form_a + form_b, t, s.a.normal);
  const bool nearest = s.a.normal.dot(s.b.normal) < 0.0 && carried.determinant() > 0.0 && carried.trace() > 0.0 &&
                       opening.smaller > -1e-12 / size;
  out.status = nearest ? HertzianPoints::Status::found : HertzianPoints::Status::not_nearest;
  return out;
}

}  // namespace

HertzianPoints find_hertzian_points(const SmoothSurface& a, const Pose& pose_a, const SmoothSurface& b,
                                    const Pose& pose_b, const Vec3& guess) {
  constexpr int most_steps = 60, most_halvings = 12;
  const double size = std::max(a.size, b.size);
  const Surfaces both{a, b, pose_a.orientation.toRotationMatrix(), pose_b.orientation.toRotationMatrix(),
                      pose_b.position - pose_a.position};
  const Vec3 start = foot(a, both.turn_a, guess);
  const Vec3 outward = both.at(start, 0.0).a.normal;
  State s = both.at(start, outward.dot(foot(b, both.turn_b, start - both.between) + both.between - start));
  const State other = both.at(start, outward.dot(foot(b, both.turn_b, guess - both.between) + both.between - start));
  if (other.merit(size) < s.merit(size)) s = other;  // not so where B has no foot for the guess, as at a centre
  for (int k = 1; k <= most_steps; ++k) {
    Eigen::Vector4d step = newton_step(s);
    if (!step.allFinite()) return {};
    const bool settled = step.norm() < 1e-13 * size;
    step *= std::min(1.0, 0.3 * size / step.norm());  // far away the model is worth little
    State next = both.at(s.x - step.head<3>(), s.gap - step[3]);
    for (int h = 0; !settled && h < most_halvings && !(next.merit(size) < s.merit(size)); ++h) {
      step *= 0.5;
      next = both.at(s.x - step.head<3>(), s.gap - step[3]);
    }
    s = next;
    if (!settled) continue;
    HertzianPoints out = describe(s, both.between, size);
    out.iterations = k;
    return out;
  }
  return {};
}

}  // namespace epafi
