#include "detection/narrow/gjk/common_normal.h"

#include "detection/narrow/gjk/two_normals.h"

namespace epafi {
namespace {

constexpr int most_steps = 16;          // ellipsoids of 1:20 need up to 9
constexpr double equal_points = 1e-13;  // of the size: the points lie on one normal; the gap errs by its square
constexpr double full_step = 1e-4;      // radian: near the end rounding, not the gap, would decide on the step's length

Mat3 adjugate(const Mat3& m) {  // of a symmetric matrix
  Mat3 out;
  out.col(0) = m.col(1).cross(m.col(2));
  out.col(1) = m.col(2).cross(m.col(0));
  out.col(2) = m.col(0).cross(m.col(1));
  return out;
}

/// The difference A - B at one unit direction.
struct DifferenceAt {
  Vec3 normal, on_a, on_b;
  Mat3 curvature;  ///< sum of the two derivatives [m]
  double gap;
};

class Search {
 public:
  Search(const RoundRef& a, const RoundRef& b, const Mat3& rotation, const Vec3& offset)
      : a_(a), b_(b), rotation_(rotation), offset_(offset) {}

  DifferenceAt at(const Vec3& n) const {
    const CurvedSupport x = a_.curved_support_of(a_.shape, n);
    const CurvedSupport y = b_.curved_support_of(b_.shape, -(rotation_.transpose() * n));
    DifferenceAt d{n, x.point, rotation_ * y.point + offset_, x.derivative, 0.0};
    d.curvature += rotation_ * y.derivative * rotation_.transpose();
    d.gap = n.dot(d.on_b - d.on_a);
    return d;
  }

 private:
  const RoundRef &a_, &b_;
  const Mat3& rotation_;
  const Vec3& offset_;
};

/// Newton's step on the unit sphere: (K + g) t = q, with K the curvature across n and q the way from A's point to B's
/// across n. Where K + g is not positive the overlap is deeper than a radius; K alone then leads uphill all the same.
Vec3 newton_step(const DifferenceAt& d, const Vec3& across, const Tangents& t) {
  const Vec3 ku = d.curvature * t.u, kv = d.curvature * t.v;
  const double uu = t.u.dot(ku), uv = t.u.dot(kv), vv = t.v.dot(kv);
  const double g = (uu + d.gap > 0.0 && (uu + d.gap) * (vv + d.gap) > uv * uv) ? d.gap : 0.0;
  const double p = uu + g, r = vv + g, determinant = p * r - uv * uv;
  const double qu = t.u.dot(across), qv = t.v.dot(across);
  if (!(determinant > 0.0)) return Vec3::Zero();
  return t.u * ((r * qu - uv * qv) / determinant) + t.v * ((p * qv - uv * qu) / determinant);
}

Vec3 turned(const Vec3& n, const Vec3& step) {
  const Vec3 sum = n + step;
  return sum / std::sqrt(sum.squaredNorm());
}

CommonNormal answer(CommonNormal::Status status, const DifferenceAt& d, int steps) {
  return {status, d.gap, d.normal, d.on_a, d.on_b, steps};
}

}  // namespace

Vec3 first_normal(const RoundRef& a, const RoundRef& b, const Mat3& rotation, const Vec3& offset) {
  const Mat3 stretched = rotation * b.semi_axes.asDiagonal();
  Mat3 sum = stretched * stretched.transpose();
  sum.diagonal() += a.semi_axes.cwiseProduct(a.semi_axes);
  const Vec3 n = adjugate(sum) * offset;
  const double size = std::sqrt(n.squaredNorm());
  return size > 0.0 ? Vec3(n / size) : Vec3::UnitZ();
}

CommonNormal common_normal(const RoundRef& a, const RoundRef& b, const Mat3& rotation, const Vec3& offset,
                           double limit) {
  if (a.turned_of || b.turned_of) return two_normals(a, b, rotation, offset, limit);
  const Search search(a, b, rotation, offset);
  const double size = std::max(a.semi_axes.maxCoeff(), b.semi_axes.maxCoeff());
  const double certain_depth = 0.99 * (a.least_radius + b.least_radius);
  DifferenceAt here = search.at(first_normal(a, b, rotation, offset));
  for (int k = 0; k < most_steps; ++k) {
    if (here.gap > limit) return answer(CommonNormal::Status::beyond, here, k);
    const Vec3 way = here.on_b - here.on_a, across = way - here.gap * here.normal;
    if (across.squaredNorm() <= equal_points * equal_points * size * size)
      return answer(here.gap > -certain_depth ? CommonNormal::Status::found : CommonNormal::Status::uncertain, here, k);
    Vec3 step = newton_step(here, across, Tangents(here.normal));
    const double length = std::sqrt(step.squaredNorm());
    if (!(length > 0.0)) break;
    if (length > 0.5) step *= 0.5 / length;
    DifferenceAt next = search.at(turned(here.normal, step));
    for (int half = 0; half < 20 && length > full_step && !(next.gap > here.gap); ++half) {
      step *= 0.5;
      next = search.at(turned(here.normal, step));
    }
    here = next;
  }
  return answer(CommonNormal::Status::uncertain, here, most_steps);
}

}  // namespace epafi
