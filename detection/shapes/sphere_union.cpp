#include "detection/shapes/sphere_union.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace epafi {

namespace {

constexpr double pi = 3.14159265358979323846;

struct Disc {
  double x, y, r;
};

/// Moments of a plane region: area, first and second moments about the origin.
struct PlaneMoments {
  double one = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
};

/// Adds the boundary integrals along an arc, counter-clockwise. Trigonometric polynomials of degree 4: 12 points on a
/// quarter give all digits.
void add_arc(const Disc& d, double from, double to, PlaneMoments& m) {
  static const GaussRule rule = gauss_rule(12);
  const int parts = std::max(1, static_cast<int>(std::ceil((to - from) / (0.5 * pi))));
  for (int p = 0; p < parts; ++p) {
    const double half = 0.5 * (to - from) / parts, middle = from + (2 * p + 1) * half;
    for (std::size_t k = 0; k < rule.node.size(); ++k) {
      const double t = middle + half * rule.node[k], c = std::cos(t), s = std::sin(t);
      const double x = d.x + d.r * c, y = d.y + d.r * s, w = half * rule.weight[k] * d.r, dy = w * c, dx = -w * s;
      m.one += 0.5 * (x * dy - y * dx);
      m.x += 0.5 * x * x * dy;
      m.y -= 0.5 * y * y * dx;
      m.xx += x * x * x * dy / 3;
      m.yy -= y * y * y * dx / 3;
      m.xy += 0.5 * x * x * y * dy;
    }
  }
}

/// Moments of a union of discs: of each the arcs that no other covers.
PlaneMoments union_moments(const std::vector<Disc>& discs) {
  PlaneMoments m;
  std::vector<std::pair<double, double>> covered;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const Disc& d = discs[i];
    covered.clear();
    bool inside = false;
    for (std::size_t j = 0; j < discs.size() && !inside; ++j) {
      if (i == j) continue;
      const Disc& o = discs[j];
      const double dx = o.x - d.x, dy = o.y - d.y, distance = std::hypot(dx, dy);
      if (distance >= d.r + o.r) continue;
      if (distance <= std::abs(o.r - d.r)) {  // one lies in the other; of equal ones the first stays
        inside = o.r > d.r || (o.r == d.r && j < i);
        continue;
      }
      const double towards = std::atan2(dy, dx);
      const double cosine = (d.r * d.r + distance * distance - o.r * o.r) / (2 * d.r * distance);
      const double half = std::acos(std::clamp(cosine, -1.0, 1.0));
      double from = towards - half, to = towards + half;
      if (from < -pi) {
        covered.push_back({from + 2 * pi, pi});
        from = -pi;
      }
      if (to > pi) {
        covered.push_back({-pi, to - 2 * pi});
        to = pi;
      }
      covered.push_back({from, to});
    }
    if (inside) continue;
    std::sort(covered.begin(), covered.end());
    double at = -pi;
    for (const auto& [from, to] : covered) {
      if (from > at) add_arc(d, at, from, m);
      at = std::max(at, to);
    }
    if (at < pi) add_arc(d, at, pi, m);
  }
  return m;
}

/// Heights of the points that three spheres share.
void add_triple_points(const PlacedBall& p, const PlacedBall& q, const PlacedBall& r, std::vector<double>& heights) {
  const Vec3 u = q.centre - p.centre, v = r.centre - p.centre, n = u.cross(v);
  const double area2 = n.squaredNorm();
  if (area2 < 1e-24 * u.squaredNorm() * v.squaredNorm()) return;
  const double a = 0.5 * (u.squaredNorm() + p.radius * p.radius - q.radius * q.radius),
               b = 0.5 * (v.squaredNorm() + p.radius * p.radius - r.radius * r.radius);
  const Vec3 foot = (a * v.cross(n) + b * n.cross(u)) / area2;  // u.x = a, v.x = b in the plane of the centres
  const double left = p.radius * p.radius - foot.squaredNorm();
  if (left < 0) return;
  const double rise = std::sqrt(left / area2) * n.z(), z = p.centre.z() + foot.z();
  heights.push_back(z - rise);
  heights.push_back(z + rise);
}

std::vector<double> heights_of_change(std::span<const PlacedBall> balls) {
  std::vector<double> z;
  std::vector<std::vector<std::size_t>> meets(balls.size());
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const PlacedBall& p = balls[i];
    z.push_back(p.centre.z() - p.radius);
    z.push_back(p.centre.z() + p.radius);
    for (std::size_t j = i + 1; j < balls.size(); ++j) {
      const PlacedBall& q = balls[j];
      const Vec3 d = q.centre - p.centre;
      const double l2 = d.squaredNorm(), sum = p.radius + q.radius, difference = p.radius - q.radius;
      if (l2 >= sum * sum || l2 <= difference * difference) continue;
      meets[i].push_back(j);
      const double share = 0.5 * (1 + (p.radius * p.radius - q.radius * q.radius) / l2);
      const double circle = std::sqrt(std::max(0.0, p.radius * p.radius - share * share * l2));
      const double middle = p.centre.z() + share * d.z(),
                   rise = circle * std::sqrt(std::max(0.0, 1 - d.z() * d.z() / l2));
      z.push_back(middle - rise);
      z.push_back(middle + rise);
    }
    for (std::size_t j : meets[i])
      for (std::size_t k : meets[i])
        if (j < k) add_triple_points(p, balls[j], balls[k], z);
  }
  std::sort(z.begin(), z.end());
  return z;
}

}  // namespace

GaussRule gauss_rule(int points) {
  GaussRule rule;
  for (int i = 0; i < points; ++i) {
    double x = std::cos(pi * (i + 0.75) / (points + 0.5)), slope = 0;
    for (int step = 0; step < 100; ++step) {  // Newton on the Legendre polynomial
      double before = 1, now = x;
      for (int n = 2; n <= points; ++n) before = std::exchange(now, ((2 * n - 1) * x * now - (n - 1) * before) / n);
      slope = points * (x * now - before) / (x * x - 1);
      const double change = now / slope;
      x -= change;
      if (std::abs(change) < 1e-16) break;
    }
    rule.node.push_back(x);
    rule.weight.push_back(2 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

MassProperties union_mass_properties(std::span<const PlacedBall> balls) {
  static const GaussRule rule = gauss_rule(24);
  const std::vector<double> heights = heights_of_change(balls);
  const double size = heights.back() - heights.front();
  const Vec3 origin = balls.front().centre;
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  std::vector<Disc> discs;
  for (std::size_t s = 1; s < heights.size(); ++s) {
    const double half = 0.5 * (heights[s] - heights[s - 1]), middle = 0.5 * (heights[s] + heights[s - 1]);
    if (half < 1e-14 * size) continue;
    for (std::size_t k = 0; k < rule.node.size(); ++k) {
      const double z = middle + half * std::sin(0.5 * pi * rule.node[k]);
      const double weight = half * 0.5 * pi * std::cos(0.5 * pi * rule.node[k]) * rule.weight[k];
      discs.clear();
      for (const PlacedBall& b : balls) {
        const double dz = z - b.centre.z(), r2 = b.radius * b.radius - dz * dz;
        if (r2 > 0) discs.push_back({b.centre.x() - origin.x(), b.centre.y() - origin.y(), std::sqrt(r2)});
      }
      const PlaneMoments m = union_moments(discs);
      const double h = z - origin.z();
      volume += weight * m.one;
      first += weight * Vec3(m.x, m.y, h * m.one);
      Mat3 q;
      q << m.xx, m.xy, h * m.x, m.xy, m.yy, h * m.y, h * m.x, h * m.y, h * h * m.one;
      second += weight * q;
    }
  }
  const Vec3 centre = first / volume;
  const Mat3 about = second - volume * centre * centre.transpose();
  return {volume, origin + centre, about.trace() * Mat3::Identity() - about};
}

}  // namespace epafi
