#include "detection/narrow/gjk/superquadric_pairs.h"

#include <algorithm>
#include <array>
#include <vector>

#include "detection/narrow/gjk/two_normals.h"
#include "detection/shapes/superquadric_lanes.h"
#include "engine/lanes/lane_bits.h"
#include "engine/lanes/targets.h"

namespace epafi {
namespace {

/// One body of each pair at a normal of its own, as OwnNormal of two_normals.cpp.
template <LaneVector V>
struct OwnNormals {
  VectorsOf<V> normal, point, outward;
  MatricesOf<V> curvature;
  SupportLanes<V> there;
};

/// TwoNormals of two_normals.cpp, one pair a lane.
template <LaneVector V>
struct NormalLanes {
  using V3 = VectorsOf<V>;
  using M = MaskOf<V>;
  SuperquadricLanes<V> a, b;
  MatricesOf<V> rotation, back;
  V3 offset;
  OwnNormals<V> on_a, on_b;
  V3 next, turn_of_a, turn_of_b, way_of_a, way_of_b;
  V change;
  M goes_on, may_end;

  EPAFI_LANES static V all(double x) { return V{} + x; }

  /// See first_normal().
  EPAFI_LANES V3 first_normal() const {
    MatricesOf<V> stretched = rotation;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) stretched.at[i][j] = rotation.at[i][j] * b.axes[j];
    MatricesOf<V> sum = stretched * stretched.transposed();
    for (int i = 0; i < 3; ++i) sum.at[i][i] = sum.at[i][i] + a.axes[i] * a.axes[i];
    MatricesOf<V> adjugate;
    for (int j = 0; j < 3; ++j) adjugate.set_column(j, sum.column((j + 1) % 3).cross(sum.column((j + 2) % 3)));
    const V3 n = adjugate * offset;
    const V size = sqrt(n.dot(n));
    const M some = size > 0.0;
    return {select(some, n.x / size, all(0.0)), select(some, n.y / size, all(0.0)), select(some, n.z / size, all(1.0))};
  }

  EPAFI_LANES void turn_a(const V3& outward) {
    on_a.there = a.support(outward);
    on_a.outward = on_a.normal = outward;
    on_a.point = on_a.there.point;
    on_a.curvature = on_a.there.derivative;
  }
  EPAFI_LANES void turn_b(const V3& outward) {
    on_b.there = b.support(outward);
    on_b.outward = outward;
    on_b.normal = -(rotation * outward);
    on_b.point = rotation * on_b.there.point + offset;
    on_b.curvature = (rotation * on_b.there.derivative) * back;
  }
  EPAFI_LANES void begin() {
    const V3 n = first_normal();
    turn_a(n);
    turn_b(-(back * n));
  }
  EPAFI_LANES V first_gap() const { return on_a.normal.dot(on_b.point - on_a.point); }

  /// goes_on: lanes in which there is a step; may_end: in which it may be the last one.
  EPAFI_LANES void find_step() {
    constexpr double longest_turn = 0.4;
    const V3 sum = on_a.normal + on_b.normal;
    const V length = sqrt(sum.dot(sum));
    const V3 n{sum.x / length, sum.y / length, sum.z / length}, way = on_b.point - on_a.point;
    const V gap = n.dot(way);
    const V3 across = way - gap * n + on_a.curvature * (on_a.normal - n) + on_b.curvature * (on_b.normal - n);
    V3 u, v;
    tangents(n, u, v);
    const MatricesOf<V> curvature = on_a.curvature + on_b.curvature;
    const V3 ku = curvature * u, kv = curvature * v;
    const V uu = u.dot(ku), uv = u.dot(kv), vv = v.dot(kv);
    const M shallow = (uu + gap > 0.0) & ((uu + gap) * (vv + gap) > uv * uv);
    const V g = select(shallow, gap, all(0.0));
    const V p = uu + g, r = vv + g, determinant = p * r - uv * uv;
    const V qu = u.dot(across), qv = v.dot(across);
    V3 turn = ((r * qu - uv * qv) / determinant) * u + ((p * qv - uv * qu) / determinant) * v;
    const V angle = sqrt(turn.dot(turn));
    const M is_long = angle > longest_turn;
    const V part = longest_turn / angle;
    turn = {select(is_long, turn.x * part, turn.x), select(is_long, turn.y * part, turn.y),
            select(is_long, turn.z * part, turn.z)};
    next = n + turn;
    const V size = sqrt(next.dot(next));
    next = {next.x / size, next.y / size, next.z / size};
    turn_of_a = next - on_a.normal;
    turn_of_b = next - on_b.normal;
    way_of_a = on_a.curvature * turn_of_a;
    way_of_b = on_b.curvature * turn_of_b;
    change = 0.5 * (turn_of_a.dot(way_of_a) + turn_of_b.dot(way_of_b) + select(g < 0.0, -g, g) * turn.dot(turn));
    goes_on = (length > 0.5) & (determinant > 0.0);
    may_end = shallow & ~is_long;
  }

  EPAFI_LANES V expected_gap() const { return next.dot((on_b.point - way_of_b) - (on_a.point + way_of_a)); }

  EPAFI_LANES void step(const V& share) {
    turn_a(a.turned(on_a.outward, on_a.there, share * turn_of_a));
    turn_b(b.turned(on_b.outward, on_b.there, back * (-share * turn_of_b)));
  }

  /// See TwoNormals::last_line.
  EPAFI_LANES void last_line(V3& first, V3& second, V& gap) const {
    first = (on_a.point + way_of_a) - (0.5 * turn_of_a.dot(way_of_a)) * next;
    second = (on_b.point - way_of_b) + (0.5 * turn_of_b.dot(way_of_b)) * next;
    const V3 way = second - first;
    gap = next.dot(way);
    const V3 beside = way - gap * next;
    first = first + 0.5 * beside;
    second = second - 0.5 * beside;
  }

 private:
  /// See Tangents.
  EPAFI_LANES static void tangents(const V3& n, V3& u, V3& v) {
    const V sign = select(n.z < 0.0, all(-1.0), all(1.0));
    const V a = -1.0 / (sign + n.z), b = n.x * n.y * a;
    u = {1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    v = {b, sign + n.y * n.y * a, -n.y};
  }
};

/// Pairs of one pair of exponents; those that a lane does not settle are left as `uncertain`.
struct PairsAtOnce {
  std::span<const SuperquadricPair> pairs;
  std::span<CommonNormal> answers;

  template <int n>
  EPAFI_LANES void run() const {
    for (std::size_t k = 0; k < pairs.size(); k += n) several<n>(k, std::min<std::size_t>(n, pairs.size() - k));
  }

 private:
  template <int n>
  EPAFI_LANES void several(std::size_t first, std::size_t count) const {
    using V = typename LanesOf<n>::Real;
    using M = MaskOf<V>;
    constexpr int most_rounds = 24;
    constexpr double shorter = 0.9, least_share = 0.25, gap_of_last_step = 1e-12;
    NormalLanes<V> lanes{};
    V limit, allowed, certain_depth;
    for (int l = 0; l < n; ++l) {  // lanes behind the last pair repeat it
      const SuperquadricPair& p = pairs[first + std::min<std::size_t>(static_cast<std::size_t>(l), count - 1)];
      put(p, l, lanes);
      limit[l] = p.limit;
      allowed[l] = gap_of_last_step * std::max(p.a->semi_axes.maxCoeff(), p.b->semi_axes.maxCoeff());
      certain_depth[l] = 0.99 * (p.a->least_radius() + p.b->least_radius());
    }
    lanes.begin();
    const V first_gap = lanes.first_gap();
    M open = first_gap <= limit;  // the others and those of no number are done
    for (int l = 0; l < n; ++l)
      if (first_gap[l] > limit[l] && static_cast<std::size_t>(l) < count)
        answers[first + static_cast<std::size_t>(l)] = beyond(lanes, first_gap, l);
    V before = V{} + infinity, share = V{} + 1.0;
    for (int k = 0; k < most_rounds && any_of<n>(open); ++k) {
      lanes.find_step();
      open = open & lanes.goes_on & ~(lanes.a.odd | lanes.b.odd);
      const M last = open & lanes.may_end & (lanes.change <= allowed);
      if (any_of<n>(last)) finish<n>(lanes, last, certain_depth, first, count, k);
      open = open & ~last & (lanes.expected_gap() <= limit);
      const M longer = lanes.change > shorter * before;
      share = select(longer, max(V{} + least_share, 0.5 * share), min(V{} + 1.0, 2.0 * share));
      before = lanes.change;
      lanes.step(share);
    }
  }

  template <int n, class V>
  EPAFI_LANES void finish(const NormalLanes<V>& lanes, const MaskOf<V>& last, const V& certain_depth, std::size_t first,
                          std::size_t count, int steps) const {
    VectorsOf<V> on_a, on_b;
    V gap;
    lanes.last_line(on_a, on_b, gap);
    for (int l = 0; l < n; ++l) {
      if (last[l] == 0 || static_cast<std::size_t>(l) >= count || !(gap[l] > -certain_depth[l])) continue;
      answers[first + static_cast<std::size_t>(l)] = {
          CommonNormal::Status::found, gap[l], of_lane(lanes.next, l), of_lane(on_a, l), of_lane(on_b, l), steps};
    }
  }
  template <class V>
  static CommonNormal beyond(const NormalLanes<V>& lanes, const V& gap, int l) {
    return {CommonNormal::Status::beyond, gap[l], of_lane(lanes.on_a.normal, l), of_lane(lanes.on_a.point, l),
            of_lane(lanes.on_b.point, l), 0};
  }
  template <class V>
  static Vec3 of_lane(const VectorsOf<V>& x, int l) {
    return {x.x[l], x.y[l], x.z[l]};
  }
  template <int n, class M>
  EPAFI_LANES static bool any_of(const M& mask) {
    long long all = 0;
    for (int l = 0; l < n; ++l) all |= mask[l];
    return all != 0;
  }
  template <class V>
  EPAFI_LANES static void put(const SuperquadricPair& p, int l, NormalLanes<V>& to) {
    to.a.put(*p.a, l);
    to.b.put(*p.b, l);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) to.rotation.at[i][j][l] = to.back.at[j][i][l] = p.rotation(i, j);
    to.offset.x[l] = p.offset.x();
    to.offset.y[l] = p.offset.y();
    to.offset.z[l] = p.offset.z();
  }
};

}  // namespace

void two_normals(std::span<const SuperquadricPair> pairs, std::span<CommonNormal> answers) {
  const auto loop = best_loop<PairsAtOnce>();
  const auto same_exponents = [](const SuperquadricPair& p, const SuperquadricPair& q) {
    return p.a->across == q.a->across && p.a->along == q.a->along && p.b->across == q.b->across &&
           p.b->along == q.b->along;
  };
  for (std::size_t k = 0, end = 0; k < pairs.size(); k = end) {
    while (end < pairs.size() && same_exponents(pairs[k], pairs[end])) ++end;
    const std::span<CommonNormal> found = answers.subspan(k, end - k);
    std::ranges::fill(found, CommonNormal{});
    loop({pairs.subspan(k, end - k), found});
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (answers[k].status != CommonNormal::Status::uncertain) continue;
    const SuperquadricPair& p = pairs[k];
    answers[k] = two_normals(RoundRef::to(*p.a), RoundRef::to(*p.b), p.rotation, p.offset, p.limit);
  }
}

}  // namespace epafi
