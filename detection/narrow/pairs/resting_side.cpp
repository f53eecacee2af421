#include "detection/narrow/pairs/resting_side.h"

#include "detection/shapes/whole_root.h"

namespace epafi {

namespace {

constexpr int least_flat = 4;          // exponent: below, the surface turns with its direction
constexpr double equally_deep = 5e-8;  // of the size, below the top: half of that in manifold.cpp

/// Coordinate over the semi-axis where x^k leaves a surface that is `drop` below its top.
double half_width(double drop, int k) { return whole_root(1.0 - whole_power(1.0 - drop, k), k); }

/// The line along z of a round section.
FlatSide line_along(const Superquadric& s, const Vec3& d) {
  FlatSide side;
  const Vec3 stretched = s.semi_axes.cwiseProduct(Vec3(d.x(), d.y(), 0.0));
  const Vec3 top = s.semi_axes.cwiseProduct(stretched.normalized());
  const double z = s.semi_axes.z() * half_width(equally_deep * s.bounding_radius() / top.norm(), s.along);
  side.corner = {Vec3(top.x(), top.y(), z), Vec3(top.x(), top.y(), -z)};
  side.count = 2;
  return side;
}

}  // namespace

FlatSide resting_side(const Superquadric& s, const Vec3& d) {
  FlatSide side;
  const double limit = facing_sine * facing_sine * d.squaredNorm();
  if (s.across == 2 && s.along >= least_flat && d.z() * d.z() < limit) return line_along(s, d);
  Eigen::Index up = 0;
  const double top = d.cwiseAbs().maxCoeff(&up);
  if (d.squaredNorm() - top * top >= limit || s.along < least_flat || (up != 2 && s.across < least_flat)) return side;
  // across the z axis both ways by `along`; of a side end by `across` to the next side, and by `along` along z
  for (const double sign : {1.0, -1.0})
    for (const Eigen::Index way : {(up + 1) % 3, (up + 2) % 3}) {
      const int exponent = up == 2 || way == 2 ? s.along : s.across;
      Vec3& x = side.corner[static_cast<std::size_t>(side.count++)];
      x = Vec3::Zero();
      x[up] = std::copysign(s.semi_axes[up], d[up]);
      x[way] = sign * s.semi_axes[way] * half_width(equally_deep * s.bounding_radius() / s.semi_axes[up], exponent);
    }
  return side;
}

void rest_on_plane(const FlatSide& side, const NearestPoint& nearest, double height, double size, double radius,
                   const PairQuery& q, ContactSink& sink) {
  static thread_local std::vector<PatchPoint> points;  // keeps its size
  points.clear();
  for (int k = 0; k < side.count; ++k) {
    const Vec3 x = q.a.orientation * side.corner[static_cast<std::size_t>(k)];
    const double gap = std::max(nearest.gap, height - nearest.normal.dot(x));
    if (!(gap < q.reach)) continue;
    const auto name = make_feature(FeatureKind::vertex_a, static_cast<std::uint32_t>(k), 0);
    points.push_back({x + 0.5 * gap * nearest.normal, gap, name});
  }
  Patch patch;
  keep_with_nearest(points, nearest, size, false, patch);
  for (int k = 0; k < patch.count; ++k) {
    const PatchPoint& p = patch.point[static_cast<std::size_t>(k)];
    sink.add({p.gap, nearest.normal, p.position, radius, p.feature});
  }
}

}  // namespace epafi
