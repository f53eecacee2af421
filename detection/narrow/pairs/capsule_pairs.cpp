#include "detection/narrow/pairs/capsule_pairs.h"

#include <algorithm>
#include <cmath>

namespace epafi {
namespace {

/// Spheres of radius ra about p and rb about q (world axes, relative to A's centre); fallback() parts concentric ones.
template <class Fallback>
void add_spheres(const Vec3& p, double ra, const Vec3& q, double rb, const Fallback& fallback, Feature feature,
                 const PairQuery& query, ContactSink& sink) {
  const Vec3 d = q - p;
  const double distance = d.norm(), gap = distance - ra - rb;
  if (!(gap < query.reach)) return;
  const Vec3 n = distance > 0.0 ? Vec3(d / distance) : Vec3(fallback());
  sink.add({gap, n, p + (ra + 0.5 * gap) * n, effective_radius(ra, rb), feature});
}

Vec3 orthogonal_to(const Vec3& u) {
  const Vec3 axis = std::abs(u.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitY();
  return u.cross(axis).normalized();
}

}  // namespace

[[gnu::flatten]] void collide_closed(const Sphere& a, const Capsule& b, const PairQuery& q, ContactSink& sink) {
  const Vec3 axis = q.b.orientation * Vec3::UnitZ(), centre = q.b.position - q.a.position;
  const double along = std::clamp(-centre.dot(axis), -b.half_length(), b.half_length());
  add_spheres(
      Vec3::Zero(), a.radius, centre + along * axis, b.radius, [&] { return orthogonal_to(axis); }, 0, q, sink);
}

/// Flattened: Eigen's turn of a vector stays a call otherwise, an eighth of a step of capsules.
[[gnu::flatten]] void collide_closed(const Capsule& a, const Capsule& b, const PairQuery& q, ContactSink& sink) {
  const Vec3 c = q.b.position - q.a.position;
  const double la = a.half_length(), lb = b.half_length(), far = la + lb + a.radius + b.radius + q.reach;
  if (c.squaredNorm() > 1.000001 * far * far) return;  // by more than rounding
  const Vec3 u = q.a.orientation * Vec3::UnitZ(), v = q.b.orientation * Vec3::UnitZ(), normal = u.cross(v);
  const double cosine = u.dot(v), cu = c.dot(u), cv = c.dot(v), sine2 = normal.squaredNorm();
  const auto across = [&]() -> Vec3 {  // crossing axes part along their common normal, collinear ones anyhow across
    return sine2 > 0.0 ? normal.normalized() : orthogonal_to(u);
  };
  const auto add = [&](double s, double t, Feature feature) {
    add_spheres(s * u, a.radius, c + t * v, b.radius, across, feature, q, sink);
  };
  const auto on_a = [&](double t) {
    return std::clamp(cu + t * cosine, -la, la);
  };  // point of A nearest to B's point t
  const auto on_b = [&](double s) { return std::clamp(s * cosine - cv, -lb, lb); };
  if (sine2 > 1e-6) {
    // Unbounded closest points, then B's parameter from A's, then A's from B's (Ericson 2005, 5.1.9).
    const double s = std::clamp((cu - cosine * cv) / sine2, -la, la);
    const double t = on_b(s);
    return add(on_a(t), t, 0);
  }
  // Common length, measured along A.
  const double end = lb * std::abs(cosine);
  const double low = std::max(-la, cu - end), high = std::min(la, cu + end);
  if (a.is_short() || b.is_short() || !(high - low > 1e-6 * (la + lb))) {
    const double s = std::clamp(0.5 * (low + high), -la, la), t = on_b(s);
    return add(on_a(t), t, 0);
  }
  add(low, on_b(low), 0);
  add(high, on_b(high), 1);
}

[[gnu::flatten]] void collide_closed(const Capsule& a, const HalfSpace& b, const PairQuery& q, ContactSink& sink) {
  const Vec3 outward = q.b.orientation * b.normal, axis = q.a.orientation * Vec3::UnitZ();
  const double height = outward.dot(q.a.position - q.b.position);
  const auto add = [&](double along, Feature feature) {
    const Vec3 centre = along * axis;
    const double gap = height + outward.dot(centre) - a.radius;
    if (gap < q.reach) sink.add({gap, -outward, centre - a.radius * outward, a.radius, feature});
  };
  const double tilt = outward.dot(axis);
  if (a.is_short()) return add(tilt > 0.0 ? -a.half_length() : tilt < 0.0 ? a.half_length() : 0.0, 0);
  add(-a.half_length(), 0);
  add(a.half_length(), 1);
}

void collide_closed(const Cylinder& a, const HalfSpace& b, const PairQuery& q, ContactSink& sink) {
  const Vec3 outward = q.b.orientation * b.normal;
  const Vec3 local = q.a.orientation.conjugate() * outward;  // the plane's normal in the body's axes
  const double height = outward.dot(q.a.position - q.b.position);
  const double lower = local.z() > 0.0 ? -a.half_length() : a.half_length();
  const double across = std::sqrt(local.x() * local.x() + local.y() * local.y());
  // Upright to within rounding the lowest point of the rim is anywhere: it is taken where the body has its x axis.
  constexpr double upright = 1e-6;
  const Vec3 low = across > 0.0 ? Vec3(-a.radius * local.x() / across, -a.radius * local.y() / across, 0.0)
                                : Vec3(a.radius, 0.0, 0.0);
  const Vec3 down = across > upright ? low : Vec3(a.radius, 0.0, 0.0), end(0.0, 0.0, lower);
  const auto add = [&](const Vec3& p, double gap, Feature feature) {
    if (gap < q.reach) sink.add({gap, -outward, q.a.orientation * p - 0.5 * gap * outward, contact_radius(a), feature});
  };
  add(end + down, height + local.dot(end + low), 0);  // its depth is that of the rim, to the last bit
  if (across < 0.5) {
    // Steeper than 60 degrees it stands or rolls on its rim, with points that follow the lowest one: their springs have
    // a potential, and no point fixed in the body receives the impulse of a passing one (Euler's disk).
    const Vec3 aside(-down.y(), down.x(), 0.0);
    const Vec3 others[] = {aside, -down, -aside};
    for (Feature k = 1; k <= 3; ++k) add(end + others[k - 1], height + local.dot(end + others[k - 1]), k);
  } else {
    add(down - end, height + local.dot(down - end), 4);
  }
}

}  // namespace epafi
