#include "detection/narrow/gjk/cylinder_distance.h"

#include <cmath>

namespace epafi {
namespace {

constexpr double even_cylinder = 1e-13;  // of the size: points of an end or of a side that are as deep as each other
constexpr double one_normal = 1e-13;     // of the size: the points lie on one normal; the gap errs by its square
constexpr int most_turns = 16;           // of random pairs none needs more than 11

/// A cylinder placed in A's axes.
struct Placed {
  Vec3 centre, axis;
  double r, h;
};

/// Certificate that no other direction is shallower than the depth d along n. For a body and its point p:
/// * a ball of radius `ball` that touches p from inside is in it: no direction is shallower than d <= ball;
/// * a cylinder with p on its rim is in it, of radius r and length l. Along m its support from p is at least
///   r (m.t)^2/2, t the tangent of the rim, and `far` |m.n| where m looks away, far = min(r, l). The sum of both bodies
///   exceeds d (1 - m.n) for every m where the lesser eigenvalue of r_a t_a t_a' + r_b t_b t_b' and the sum of both
///   `far` are at least 2 d.
struct Hold {
  double ball, radius, far;
  Vec3 tangent;
};

struct Meeting {
  bool valid = false;
  double gap = -infinity;
  Vec3 normal, on_a, on_b;  ///< normal from A to B
  Hold hold_a, hold_b;      ///< where valid and overlapping
  bool overlaps() const { return valid && gap < 0.0; }
};

/// sqrt(1 - y^2), y = n.axis, to all digits; never 0.
double length_across(const Vec3& n, double y, const Vec3& axis) {
  return std::sqrt(std::max((n - y * axis).squaredNorm(), 1e-300));
}

/// p lies on the side at `along` the axis, or on the rim.
Hold hold_on_side(const Placed& c, const Vec3& n, double along, bool rim) {
  const double inside = rim ? 0.0 : c.h - std::abs(along);
  return {std::min(c.r, inside), c.r, std::min(c.r, c.h + std::abs(along)), c.axis.cross(n).normalized()};
}

/// p lies on an end, at `across` from the axis: the cylinder through it is narrower.
Hold hold_on_end(const Placed& c, const Vec3& across) {
  const double out = std::sqrt(across.squaredNorm());
  const Vec3 tangent = out > 0.0 ? Vec3(c.axis.cross(across) / out) : Vec3(Vec3::Zero());
  return {std::min(c.r - out, c.h), out, std::min(out, 2.0 * c.h), tangent};
}

bool is_least_depth(const Meeting& m) {
  const double depth = 1.001 * -m.gap;
  const Hold &a = m.hold_a, &b = m.hold_b;
  if (depth <= std::max(a.ball, b.ball)) return true;
  const double sum = a.radius + b.radius, sine2 = a.tangent.cross(b.tangent).squaredNorm();
  const double root = std::sqrt(std::max(0.0, sum * sum - 4.0 * a.radius * b.radius * sine2));
  return 0.5 * (sum - root) >= 2.0 * depth && a.far + b.far >= 2.0 * depth;
}

Meeting exchanged(const Meeting& m) { return {m.valid, m.gap, -m.normal, m.on_b, m.on_a, m.hold_b, m.hold_a}; }

class CylinderPair {
 public:
  CylinderPair(const Placed& a, const Placed& b) : a_(a), b_(b) {
    between_ = b.centre - a.centre;
    even_ = even_cylinder * (a.r + a.h + b.r + b.h);
  }
  /// An end of A against any point of B.
  Meeting end() const;
  /// The side of A against a rim of B.
  Meeting side_and_rim() const;
  Meeting sides() const;
  Meeting rims(double limit) const;

 private:
  Vec3 middle_of_discs(const Vec3& centre, const Vec3& end) const;
  bool middle_of_segment(const Vec3& line, const Vec3& end, double& along) const;
  bool turn_to_rim(const Vec3& start, double k, Vec3& n) const;
  Vec3 first_normal() const;
  const Placed &a_, &b_;
  Vec3 between_;
  double even_;
};

/// B's end, parallel to A's: the middle of what they share along the line of their centres.
Vec3 CylinderPair::middle_of_discs(const Vec3& centre, const Vec3& end) const {
  const Vec3 way = centre - end, across = way - way.dot(a_.axis) * a_.axis;
  const double distance = std::sqrt(across.squaredNorm());
  if (!(distance > 0.0)) return centre;
  const double from = std::max(-a_.r, distance - b_.r), to = std::min(a_.r, distance + b_.r);
  return centre + (0.5 * (from + to) - distance) / distance * across;
}

/// B's side, parallel to A's end: the middle of its part over the end. line: the side's middle.
bool CylinderPair::middle_of_segment(const Vec3& line, const Vec3& end, double& along) const {
  const Vec3 way = line - end, across = way - way.dot(a_.axis) * a_.axis;
  const double foot = across.dot(b_.axis), room = a_.r * a_.r - across.squaredNorm() + foot * foot;
  if (!(room >= 0.0)) return false;
  const double half = std::sqrt(room), from = std::max(-b_.h, -foot - half), to = std::min(b_.h, -foot + half);
  along = 0.5 * (from + to);
  return from <= to;
}

Meeting CylinderPair::end() const {
  Meeting m;
  const Vec3 n = between_.dot(a_.axis) < 0.0 ? Vec3(-a_.axis) : a_.axis;
  const Vec3 end = a_.centre + a_.h * n;
  const double y = n.dot(b_.axis);
  const Vec3 across = n - y * b_.axis;
  const double size = std::sqrt(across.squaredNorm());
  const bool discs = b_.r * size <= even_, lies = b_.h > 0.0 && std::abs(y) * b_.h <= even_;
  const Vec3 to_rim = size > 0.0 ? Vec3(across / size) : Vec3(Vec3::Zero());
  double along = y > 0.0 ? -b_.h : b_.h;
  m.normal = n;
  m.valid = true;
  if (lies) m.valid = middle_of_segment(b_.centre - b_.r * to_rim, end, along);
  const Vec3 on_axis = b_.centre + along * b_.axis;
  m.on_b = discs ? middle_of_discs(on_axis, end) : Vec3(on_axis - b_.r * to_rim);
  const Vec3 way = m.on_b - end;
  // from the supports, so that a direction between the bodies is a bound whether or not the points lie over each other
  m.gap = n.dot(between_) - a_.h - b_.h * std::abs(y) - b_.r * size;
  m.on_a = m.on_b - m.gap * n;
  const Vec3 out = way - way.dot(n) * n;
  m.valid = m.valid && out.squaredNorm() <= a_.r * a_.r;
  if (!m.overlaps()) return m;
  m.hold_a = hold_on_end(a_, out);
  m.hold_b = discs ? hold_on_end(b_, m.on_b - on_axis) : hold_on_side(b_, n, along, !lies);
  return m;
}

Meeting CylinderPair::sides() const {
  Meeting m;
  const Vec3 across = a_.axis.cross(b_.axis);
  const double sine2 = across.squaredNorm();
  if (!(sine2 > 1e-12)) return m;
  // of nearly parallel axes the product is off along them too: across A's axis what is left only turns about it
  m.normal = (across - across.dot(a_.axis) * a_.axis).normalized();
  if (m.normal.dot(between_) < 0.0) m.normal = -m.normal;
  const double cosine = a_.axis.dot(b_.axis), ca = between_.dot(a_.axis), cb = between_.dot(b_.axis);
  const double s = (ca - cosine * cb) / sine2, t = (cosine * ca - cb) / sine2;
  m.gap = m.normal.dot(between_) - a_.r - b_.r;
  m.valid = std::abs(s) <= a_.h && std::abs(t) <= b_.h;
  if (!m.valid) return m;
  m.on_a = a_.centre + s * a_.axis + a_.r * m.normal;
  m.on_b = m.on_a + m.gap * m.normal;
  m.hold_a = hold_on_side(a_, m.normal, s, false);
  m.hold_b = hold_on_side(b_, m.normal, t, false);
  return m;
}

/// The direction from the ellipse of semi-axes a >= b about the origin to (x, y), x and y >= 0, outside: (x/(t + a^2),
/// y/(t + b^2)), t the root of (a x/(t + a^2))^2 + (b y/(t + b^2))^2 = 1. That falls and is convex, so Newton's method
/// climbs to the root from where one term alone is 1, however flat the ellipse. False inside.
bool leaves_ellipse(double a, double b, double& x, double& y) {
  const double a2 = a * a, b2 = b * b;
  double t = std::max(a * x - a2, b * y - b2);
  if (!(t + b2 > 0.0)) return false;
  for (int turn = 0; turn < most_turns; ++turn) {
    const double p = a * x / (t + a2), q = b * y / (t + b2), over = p * p + q * q - 1.0;
    const double step = over / (2.0 * (p * p / (t + a2) + q * q / (t + b2)));
    if (!(step > 1e-12 * (t + b2))) break;
    t += step;
  }
  x /= t + a2;
  y /= t + b2;
  return t > 0.0;
}

/// The n across A's axis along which the rim of B at k h from its centre is nearest to that axis, and its distance.
/// Across A's axis the rim is an ellipse of semi-axes r and r |u.v|, the shorter one along v. start: its centre there.
bool CylinderPair::turn_to_rim(const Vec3& start, double k, Vec3& n) const {
  const double m = a_.axis.dot(b_.axis);
  const Vec3 along = b_.axis - m * a_.axis, beside = a_.axis.cross(b_.axis);
  const double sine2 = beside.squaredNorm();
  n = start;
  if (sine2 > 1e-4 && b_.r > 0.0) {  // below, a circle to 5e-5 of its radius
    const double sine = std::sqrt(sine2), x = start.dot(beside) / sine, y = start.dot(along) / sine;
    double nx = std::abs(x), ny = std::abs(y);
    if (!leaves_ellipse(b_.r, b_.r * std::abs(m), nx, ny)) return false;
    n = (std::copysign(nx, x) * beside + std::copysign(ny, y) * along) / sine;
  }
  n -= n.dot(a_.axis) * a_.axis;  // to the last digit
  n /= std::sqrt(n.squaredNorm());
  const Vec3 centre = between_ + k * b_.h * b_.axis;
  for (int turn = 0; turn < most_turns; ++turn) {
    const Vec3 t = a_.axis.cross(n);
    const double y = n.dot(b_.axis), ty = t.dot(b_.axis), S = length_across(n, y, b_.axis);
    const double slope = t.dot(centre) + b_.r * y * ty / S;  // of n.centre - r S
    const double gap = n.dot(centre) - b_.r * S;             // from A's axis
    const double bend = gap + b_.r * m * m / (S * S * S);
    if (std::abs(slope) <= one_normal * (std::abs(gap) + b_.r)) return bend > 0.0;
    const double step = bend > 0.0 ? std::clamp(slope / bend, -0.5, 0.5) : (slope > 0.0 ? 0.5 : -0.5);
    const Vec3 next = n + step * t;
    n = next / std::sqrt(next.squaredNorm());
  }
  return false;
}

Meeting CylinderPair::side_and_rim() const {
  Meeting m;
  const Vec3 across = between_ - between_.dot(a_.axis) * a_.axis;
  const double distance = std::sqrt(across.squaredNorm());
  if (!(distance > 0.0)) return m;
  Vec3 n = across / distance;
  double k = n.dot(b_.axis) > 0.0 ? -1.0 : 1.0;
  const double sine = std::sqrt(a_.axis.cross(b_.axis).squaredNorm()), rise = b_.r * sine;  // of a rim along A's axis
  const bool parallel = sine * b_.h <= even_;
  for (int rim = 0; rim < 2; ++rim, k = -k) {
    const Vec3 centre = between_ + k * b_.h * b_.axis, start = centre - centre.dot(a_.axis) * a_.axis;
    const bool beside = !parallel && std::abs(centre.dot(a_.axis)) - rise > a_.h;  // all of the rim
    const double length = std::sqrt(start.squaredNorm());
    if (beside || !(length > 0.0) || !turn_to_rim(start, k, n)) continue;
    const double y = n.dot(b_.axis);
    const bool lies = b_.h > 0.0 && std::abs(y) * b_.h <= even_;
    if (!lies && y * k > 0.0) continue;  // the other rim is nearer
    if (lies && !parallel) return m;     // the sides cross
    const double S = length_across(n, y, b_.axis);
    m.normal = n;
    m.gap = n.dot(between_) - b_.h * std::abs(y) - b_.r * S - a_.r;
    const Vec3 to_rim = (n - y * b_.axis) / S;
    double along = k * b_.h;
    if (lies) {  // the middle of what their sides share
      const double c = a_.axis.dot(b_.axis), foot = between_.dot(a_.axis) - b_.r * to_rim.dot(a_.axis);
      const double from = std::max(-a_.h, foot - b_.h * std::abs(c)), to = std::min(a_.h, foot + b_.h * std::abs(c));
      if (!(from <= to)) return m;
      along = (0.5 * (from + to) - foot) / c;
    }
    m.on_b = b_.centre + along * b_.axis - b_.r * to_rim;
    const double s = (m.on_b - a_.centre).dot(a_.axis);
    m.on_a = a_.centre + s * a_.axis + a_.r * n;
    m.valid = std::abs(s) <= a_.h;
    if (!m.overlaps()) return m;
    m.hold_a = hold_on_side(a_, n, s, false);
    m.hold_b = hold_on_side(b_, n, along, !lies);
    return m;
  }
  return m;
}

/// A rim seen along n, the body's outward normal.
struct RimAt {
  Vec3 point, tangent;
  double bend;   ///< radius of curvature along the tangent [m]
  double reach;  ///< of the body along n from its centre [m]; from the point a rim seen from above would lose digits
  RimAt(const Placed& c, const Vec3& n) {
    const double x = n.dot(c.axis);
    const Vec3 across = n - x * c.axis;
    const double size = std::sqrt(std::max(across.squaredNorm(), 1e-300));
    point = c.centre + (x < 0.0 ? -c.h : c.h) * c.axis + (c.r / size) * across;
    tangent = c.axis.cross(across) / size;
    bend = c.r / size;
    reach = c.h * std::abs(x) + c.r * size;
  }
};

/// Two rims along n, from A to B.
struct RimsAt {
  Vec3 normal;
  RimAt a, b;
  double gap;
  Vec3 across;  ///< from A's point to B's across n
  RimsAt(const Placed& on_a, const Placed& on_b, const Vec3& n) : normal(n), a(on_a, n), b(on_b, -n) {
    const Vec3 way = b.point - a.point;
    gap = n.dot(on_b.centre - on_a.centre) - a.reach - b.reach;
    across = way - n.dot(way) * n;
  }
  /// Newton's step across n, as in common_normal.cpp: (K + gap) step = across, K of rank one for each rim. Where it is
  /// not positive the overlap is too deep or the rims run along each other: `least` instead of the gap leads uphill.
  Vec3 step(double least) const {
    const Vec3 &e = a.tangent, f = normal.cross(e);
    const double be = b.tangent.dot(e), bf = b.tangent.dot(f), ef = b.bend * be * bf;
    double ee = a.bend + b.bend * be * be + gap, ff = b.bend * bf * bf + gap;
    if (!(ff > 0.0) || !(ee * ff > ef * ef)) {
      ee += least - gap;
      ff += least - gap;
    }
    const double qe = across.dot(e), qf = across.dot(f), determinant = ee * ff - ef * ef;
    return ((ff * qe - ef * qf) / determinant) * e + ((ee * qf - ef * qe) / determinant) * f;
  }
};

Vec3 turned_by(const Vec3& n, const Vec3& step) {
  const Vec3 sum = n + step;
  return sum / std::sqrt(sum.squaredNorm());
}

/// The normal of two similar ellipsoids of revolution.
Vec3 CylinderPair::first_normal() const {
  Mat3 sum = (a_.r * a_.r + b_.r * b_.r) * Mat3::Identity();
  sum += (a_.h * a_.h - a_.r * a_.r) * a_.axis * a_.axis.transpose();
  sum += (b_.h * b_.h - b_.r * b_.r) * b_.axis * b_.axis.transpose();
  const Vec3 n = sum.inverse() * between_;
  const double size = std::sqrt(n.squaredNorm());
  return size > 0.0 && size < infinity ? Vec3(n / size) : Vec3(between_.normalized());
}

Meeting CylinderPair::rims(double limit) const {
  Meeting m;
  const double size = a_.r + a_.h + b_.r + b_.h, least = 0.01 * size;
  RimsAt here(a_, b_, first_normal());
  for (int turn = 0; turn < most_turns; ++turn) {
    m.valid = here.across.squaredNorm() <= one_normal * one_normal * size * size;
    if (m.valid || here.gap > limit) break;
    Vec3 step = here.step(least);
    const double length = std::sqrt(step.squaredNorm());
    if (!(length < infinity)) break;
    if (length > 0.5) step *= 0.5 / length;
    RimsAt next(a_, b_, turned_by(here.normal, step));
    // near the end rounding, not the gap, would decide on the step's length
    for (int half = 0; half < 10 && length > 1e-4 && !(next.gap > here.gap); ++half) {
      step *= 0.5;
      next = RimsAt(a_, b_, turned_by(here.normal, step));
    }
    here = next;
  }
  m.gap = here.gap;
  m.normal = here.normal;
  m.on_a = here.a.point;
  m.on_b = here.b.point;
  if (!m.overlaps()) return m;
  m.hold_a = hold_on_side(a_, m.normal, a_.h, true);
  m.hold_b = hold_on_side(b_, m.normal, b_.h, true);
  return m;
}

}  // namespace

CommonNormal cylinder_distance(const CylinderCore& a, const CylinderCore& b, const Mat3& rotation, const Vec3& offset,
                               double limit) {
  using Status = CommonNormal::Status;
  const Placed at_a{Vec3::Zero(), Vec3::UnitZ(), a.radius, a.half_length};
  const Placed at_b{offset, rotation.col(2), b.radius, b.half_length};
  const CylinderPair pair(at_a, at_b), back(at_b, at_a);
  CommonNormal out;
  // true where the search is over
  const auto take = [&](const Meeting& m) {
    const bool beyond = m.gap > limit;
    if (!beyond && (!m.valid || (m.overlaps() && !is_least_depth(m)))) return false;
    out = {beyond ? Status::beyond : Status::found, m.gap, m.normal, m.on_a, m.on_b, 0};
    return true;
  };
  if (take(pair.end()) || take(exchanged(back.end())) || take(pair.sides())) return out;
  if (take(pair.side_and_rim()) || take(exchanged(back.side_and_rim()))) return out;
  take(pair.rims(limit));
  return out;
}

}  // namespace epafi
