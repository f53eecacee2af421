#include "detection/narrow/gjk/two_normals.h"

#include <algorithm>

namespace epafi {
namespace {

constexpr int most_rounds = 24;             // of exponents up to 20: 7 in the mean, one pair in 500 would need more
constexpr double longest_turn = 0.4;        // radian
constexpr double shorter = 0.9;             // a step that has not become shorter by this is damped
constexpr double least_share = 0.25;        // of a damped step
constexpr double gap_of_last_step = 1e-12;  // of the size; known to second order, the third is below a tenth of this

/// One body at a normal of its own, in A's axes.
struct OwnNormal {
  Vec3 normal;  ///< from A to B
  Vec3 point;
  Mat3 curvature;
  Vec3 outward;         ///< in the body's axes
  CurvedSupport there;  ///< in the body's axes
};

/// Both bodies, and what their next step is.
class TwoNormals {
 public:
  TwoNormals(const RoundRef& a, const RoundRef& b, const Mat3& rotation, const Vec3& offset, const Vec3& n)
      : a_(a), b_(b), rotation_(rotation), back_(rotation.transpose()), offset_(offset) {
    turn_a(n);
    turn_b(-(back_ * n));
  }

  /// Where the tangents lead to; false where no step leads on.
  bool find_step() {
    const Vec3 sum = on_a_.normal + on_b_.normal;
    const double length = std::sqrt(sum.squaredNorm());
    if (!(length > 0.5)) return false;
    const Vec3 n = sum / length, way = on_b_.point - on_a_.point;
    const double gap = n.dot(way);
    const Vec3 across = way - gap * n + on_a_.curvature * (on_a_.normal - n) + on_b_.curvature * (on_b_.normal - n);
    const Tangents t(n);
    const Mat3 curvature = on_a_.curvature + on_b_.curvature;
    const Vec3 ku = curvature * t.u, kv = curvature * t.v;
    const double uu = t.u.dot(ku), uv = t.u.dot(kv), vv = t.v.dot(kv);
    // else deeper than a radius of curvature: the curvature alone leads on, to be judged by others
    shallow_ = uu + gap > 0.0 && (uu + gap) * (vv + gap) > uv * uv;
    const double g = shallow_ ? gap : 0.0;
    const double p = uu + g, r = vv + g, determinant = p * r - uv * uv;
    if (!(determinant > 0.0)) return false;
    const double qu = t.u.dot(across), qv = t.v.dot(across);
    Vec3 turn = t.u * ((r * qu - uv * qv) / determinant) + t.v * ((p * qv - uv * qu) / determinant);
    const double angle = std::sqrt(turn.squaredNorm());
    long_ = angle > longest_turn;
    if (long_) turn *= longest_turn / angle;
    next_ = n + turn;
    next_ /= std::sqrt(next_.squaredNorm());
    turn_of_a_ = next_ - on_a_.normal;
    turn_of_b_ = next_ - on_b_.normal;
    way_of_a_ = on_a_.curvature * turn_of_a_;
    way_of_b_ = on_b_.curvature * turn_of_b_;
    change_ = 0.5 * (turn_of_a_.dot(way_of_a_) + turn_of_b_.dot(way_of_b_) + std::abs(g) * turn.squaredNorm());
    return true;
  }

  /// What the step changes of the gap [m].
  double change() const { return change_; }
  bool is_last(double allowed) const { return change_ <= allowed && shallow_ && !long_; }

  double expected_gap() const { return next_.dot((on_b_.point - way_of_b_) - (on_a_.point + way_of_a_)); }

  /// Tangents leave the bodies by as much as they add to the supports.
  CommonNormal last_line(int steps) const {
    CommonNormal out{CommonNormal::Status::found, 0.0, next_, on_a_.point + way_of_a_, on_b_.point - way_of_b_, steps};
    out.on_a -= 0.5 * turn_of_a_.dot(way_of_a_) * next_;
    out.on_b += 0.5 * turn_of_b_.dot(way_of_b_) * next_;
    const Vec3 way = out.on_b - out.on_a;
    out.gap = next_.dot(way);
    const Vec3 beside = way - out.gap * next_;
    out.on_a += 0.5 * beside;
    out.on_b -= 0.5 * beside;
    return out;
  }

  void step(double share) {
    turn_a(turned(a_, on_a_, share * turn_of_a_));
    turn_b(turned(b_, on_b_, back_ * (-share * turn_of_b_)));
  }

  /// The gap along one normal, a lower bound of the distance.
  CommonNormal along(const Vec3& n) const {
    const Vec3 on_a = a_.curved_support_of(a_.shape, n).point;
    const Vec3 on_b = rotation_ * b_.curved_support_of(b_.shape, -(back_ * n)).point + offset_;
    return {CommonNormal::Status::beyond, n.dot(on_b - on_a), n, on_a, on_b, 0};
  }
  CommonNormal along_first() const {
    return {CommonNormal::Status::beyond,
            on_a_.normal.dot(on_b_.point - on_a_.point),
            on_a_.normal,
            on_a_.point,
            on_b_.point,
            0};
  }
  const Vec3& next() const { return next_; }

 private:
  static Vec3 turned(const RoundRef& body, const OwnNormal& at, const Vec3& step) {
    if (body.turned_of) return body.turned_of(body.shape, at.outward, at.there, step);
    const Vec3 sum = at.outward + step;
    return sum / std::sqrt(sum.squaredNorm());
  }
  void turn_a(const Vec3& outward) {
    on_a_.there = a_.curved_support_of(a_.shape, outward);
    on_a_.outward = on_a_.normal = outward;
    on_a_.point = on_a_.there.point;
    on_a_.curvature = on_a_.there.derivative;
  }
  void turn_b(const Vec3& outward) {
    on_b_.there = b_.curved_support_of(b_.shape, outward);
    on_b_.outward = outward;
    on_b_.normal = -(rotation_ * outward);
    on_b_.point = rotation_ * on_b_.there.point + offset_;
    on_b_.curvature = rotation_ * on_b_.there.derivative * back_;
  }

  const RoundRef &a_, &b_;
  const Mat3 rotation_, back_;
  const Vec3 offset_;
  OwnNormal on_a_, on_b_;
  Vec3 next_, turn_of_a_, turn_of_b_, way_of_a_, way_of_b_;
  double change_ = 0.0;
  bool shallow_ = false, long_ = false;
};

}  // namespace

CommonNormal two_normals(const RoundRef& a, const RoundRef& b, const Mat3& rotation, const Vec3& offset, double limit) {
  const double size = std::max(a.semi_axes.maxCoeff(), b.semi_axes.maxCoeff());
  const double certain_depth = 0.99 * (a.least_radius + b.least_radius);
  TwoNormals pair(a, b, rotation, offset, first_normal(a, b, rotation, offset));
  if (const CommonNormal first = pair.along_first(); first.gap > limit) return first;
  double before = infinity, share = 1.0;
  for (int k = 0; k < most_rounds && pair.find_step(); ++k) {
    if (pair.is_last(gap_of_last_step * size)) {
      CommonNormal out = pair.last_line(k);
      if (!(out.gap > -certain_depth)) out.status = CommonNormal::Status::uncertain;
      return out;
    }
    if (pair.expected_gap() > limit) {
      const CommonNormal bound = pair.along(pair.next());
      if (bound.gap > limit) return bound;
    }
    share = pair.change() > shorter * before ? std::max(least_share, 0.5 * share) : std::min(1.0, 2.0 * share);
    before = pair.change();
    pair.step(share);
  }
  return {};
}

}  // namespace epafi
