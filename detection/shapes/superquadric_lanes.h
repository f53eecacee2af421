/// @file superquadric_lanes.h  Support points of superquadrics, one body a lane, with the bits of superquadric.cpp:
/// sums of three go in the order in which Eigen adds them.
#pragma once
#include "detection/shapes/superquadric.h"
#include "detection/shapes/whole_root.h"
#include "engine/lanes/lane_bits.h"

namespace epafi {

/// at[row][column]
template <LaneVector V>
struct MatricesOf {
  V at[3][3];
  EPAFI_LANES VectorsOf<V> column(int j) const { return {at[0][j], at[1][j], at[2][j]}; }
  EPAFI_LANES void set_column(int j, const VectorsOf<V>& x) {
    at[0][j] = x.x;
    at[1][j] = x.y;
    at[2][j] = x.z;
  }
  EPAFI_LANES MatricesOf transposed() const {
    MatricesOf out;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out.at[i][j] = at[j][i];
    return out;
  }
  /// Eigen adds the first two of three rows by packets, from the left, and the last one from the right.
  EPAFI_LANES VectorsOf<V> operator*(const VectorsOf<V>& x) const {
    return {at[0][0] * x.x + at[0][1] * x.y + at[0][2] * x.z, at[1][0] * x.x + at[1][1] * x.y + at[1][2] * x.z,
            at[2][0] * x.x + (at[2][1] * x.y + at[2][2] * x.z)};
  }
  EPAFI_LANES MatricesOf operator*(const MatricesOf& o) const {
    MatricesOf out;
    for (int j = 0; j < 3; ++j) out.set_column(j, *this * o.column(j));
    return out;
  }
  EPAFI_LANES MatricesOf operator+(const MatricesOf& o) const {
    MatricesOf out;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out.at[i][j] = at[i][j] + o.at[i][j];
    return out;
  }
};

/// CurvedSupport in lanes.
template <LaneVector V>
struct SupportLanes {
  VectorsOf<V> point;
  MatricesOf<V> derivative;
};

/// Bodies of the same exponents.
template <LaneVector V>
struct SuperquadricLanes {
  using V3 = VectorsOf<V>;
  V axes[3];
  int across = 2, along = 2;
  MaskOf<V> odd{};  ///< lanes that come to numbers so small that whole_root() scales them

  EPAFI_LANES void put(const Superquadric& s, int lane) {
    for (int k = 0; k < 3; ++k) axes[k][lane] = s.semi_axes[k];
    across = s.across;
    along = s.along;
  }

  /// Superquadric::curved_support
  EPAFI_LANES SupportLanes<V> support(const V3& d) {
    const V3 axis = signed_axes(d);
    const UnitPoint p = unit_point(d);
    SupportLanes<V> out;
    out.point = {axis.x * p.x[0], axis.y * p.x[1], axis.z * p.x[2]};
    const V side[3] = {axis.x, axis.y, axis.z};
    V m[3][3];
    curvature(p, m);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out.derivative.at[i][j] = (side[i] * m[i][j]) * side[j];
    return out;
  }

  /// Superquadric::turned
  EPAFI_LANES V3 turned(const V3& d, const SupportLanes<V>& at, const V3& step) {
    const V3 axis = signed_axes(d), sides = times(axis, d), change = times(axis, step);
    const V3 x = over(at.point, axis), next = x + over(at.derivative * step, axis);
    const V size = x.dot(sides), growth = x.dot(change) / size;
    const V length = select(growth < 0.0, size / (1.0 - growth), size * (1.0 + growth));
    const V3 by_point = length * gradient({within_one(next.x), within_one(next.y), within_one(next.z)});
    const auto one = [&](const V& to, const V& side, const V& point)
                         EPAFI_INLINED { return select(to > 0.0, side + to, point); };
    const V3 out = over(
        {one(change.x, sides.x, by_point.x), one(change.y, sides.y, by_point.y), one(change.z, sides.z, by_point.z)},
        axis);
    const V root = sqrt(out.dot(out));
    return {out.x / root, out.y / root, out.z / root};
  }

 private:
  /// Superquadric::UnitPoint
  struct UnitPoint {
    V x[3], slope[3], reach;
    V section[2], section_slope[2], scale, scale_slope;
  };
  EPAFI_LANES static V all(double x) { return V{} + x; }
  EPAFI_LANES static V3 times(const V3& a, const V3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  EPAFI_LANES static V3 over(const V3& a, const V3& b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }
  EPAFI_LANES static V within_one(const V& x) { return min(max(x, all(-1.0)), all(1.0)); }
  EPAFI_LANES static V size_of(const V& x) {
    return reinterpret_cast<V>(reinterpret_cast<MaskOf<V>>(x) & 0x7fffffffffffffffll);
  }
  EPAFI_LANES V root(const V& x, int k) {
    odd = odd | ((x > 0.0) & (x < 0x1p-900));
    return whole_roots(x, k);
  }

  EPAFI_LANES V3 signed_axes(const V3& d) const {
    return {select(d.x < 0.0, -axes[0], axes[0]), select(d.y < 0.0, -axes[1], axes[1]),
            select(d.z < 0.0, -axes[2], axes[2])};
  }

  EPAFI_LANES UnitPoint unit_point(const V3& d) {
    const V x = size_of(axes[0] * d.x), y = size_of(axes[1] * d.y), z = size_of(axes[2] * d.z);
    const V most = max(max(x, y), z);
    const V sides[3] = {x / most, y / most, z / most};
    UnitPoint p = across == along ? of_one_exponent(sides) : of_two_exponents(sides);
    p.reach = p.reach * most;
    return p;
  }
  EPAFI_LANES UnitPoint of_one_exponent(const V (&sides)[3]) {
    V r[3];
    for (int k = 0; k < 3; ++k) r[k] = whole_roots(sides[k], along - 1);
    const V sum = sides[0] * r[0] + sides[1] * r[1] + sides[2] * r[2];
    const V of_sum = root(sum, along), norm = sum / of_sum;
    UnitPoint p{};
    for (int k = 0; k < 3; ++k) {
      p.x[k] = r[k] / of_sum;
      p.slope[k] = sides[k] / norm;
    }
    p.reach = norm;
    return p;
  }
  EPAFI_LANES UnitPoint of_two_exponents(const V (&sides)[3]) {
    UnitPoint p{};
    const MaskOf<V> some = max(sides[0], sides[1]) > 0.0;
    const V r0 = whole_roots(sides[0], across - 1), r1 = whole_roots(sides[1], across - 1);
    const V in_section = sides[0] * r0 + sides[1] * r1, of_section = root(in_section, across);
    const V beside = select(some, in_section / of_section, all(0.0));
    p.section[0] = select(some, r0 / of_section, all(1.0));
    p.section[1] = select(some, r1 / of_section, all(0.0));
    p.section_slope[0] = select(some, sides[0] / beside, all(1.0));
    p.section_slope[1] = select(some, sides[1] / beside, all(0.0));
    const V of_beside = whole_roots(beside, along - 1), of_z = whole_roots(sides[2], along - 1);
    const V sum = beside * of_beside + sides[2] * of_z, of_sum = root(sum, along), norm = sum / of_sum;
    p.scale = of_beside / of_sum;
    p.scale_slope = beside / norm;
    p.x[0] = p.section[0] * p.scale;
    p.x[1] = p.section[1] * p.scale;
    p.x[2] = of_z / of_sum;
    p.slope[2] = sides[2] / norm;
    p.reach = norm;
    return p;
  }

  EPAFI_LANES static V flatness(const V& x, const V& slope, int n) {
    constexpr double flattest = 1e8;
    if (n == 2) return all(1.0);
    return select(x < flattest * slope, x / slope, all(flattest));
  }
  EPAFI_LANES void curvature(const UnitPoint& p, V (&m)[3][3]) const {
    const V h = 1.0 / (static_cast<double>(along - 1) * p.reach);
    const V zz = flatness(p.x[2], p.slope[2], along);
    if (across == along) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m[i][j] = (-h * p.x[i]) * p.x[j];
      m[0][0] = m[0][0] + h * flatness(p.x[0], p.slope[0], along);
      m[1][1] = m[1][1] + h * flatness(p.x[1], p.slope[1], along);
      m[2][2] = m[2][2] + h * zz;
      return;
    }
    const V of_scale = flatness(p.scale, p.scale_slope, along), u = p.section[0], v = p.section[1];
    const V tt = h * (of_scale - p.scale * p.scale), tz = -h * p.scale * p.x[2];
    const V t = of_scale / (static_cast<double>(across - 1) * p.reach);
    const V uu = t * (flatness(u, p.section_slope[0], across) - u * u);
    const V vv = t * (flatness(v, p.section_slope[1], across) - v * v);
    m[0][0] = tt * u * u + uu;
    m[0][1] = m[1][0] = (tt - t) * u * v;
    m[1][1] = tt * v * v + vv;
    m[0][2] = m[2][0] = tz * u;
    m[1][2] = m[2][1] = tz * v;
    m[2][2] = h * (zz - p.x[2] * p.x[2]);
  }

  EPAFI_LANES V3 gradient(const V3& x) {
    const V3 size{size_of(x.x), size_of(x.y), size_of(x.z)};
    const V one = all(1.0);
    V of_section = one;
    if (across != along) {
      const V radius = root(whole_power_of(size.x, across, one) + whole_power_of(size.y, across, one), across);
      of_section = along > across ? whole_power_of(radius, along - across, one)
                                  : one / whole_power_of(max(radius, all(1e-6)), across - along, one);
    }
    const V gx = of_section * whole_power_of(size.x, across - 1, one),
            gy = of_section * whole_power_of(size.y, across - 1, one), gz = whole_power_of(size.z, along - 1, one);
    return {select(x.x < 0.0, -gx, gx), select(x.y < 0.0, -gy, gy), select(x.z < 0.0, -gz, gz)};
  }
};

}  // namespace epafi
