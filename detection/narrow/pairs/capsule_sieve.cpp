#include "detection/narrow/pairs/capsule_sieve.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "detection/shape_store.h"
#include "engine/lanes/targets.h"

namespace epafi {
namespace {

/// Pairs whose bounding balls meet, by column. Numbers behind the last one are those of an earlier pair.
struct Candidates {
  static constexpr std::size_t spare = 8;
  using Column = std::array<double, CapsuleSieve::room + spare>;
  std::size_t count = 0;
  std::array<std::uint32_t, CapsuleSieve::room + spare> place;
  alignas(64) Column x{}, y{}, z{};                    ///< from the centre of A to that of B [m]
  alignas(64) Column ai{}, aj{}, ak{}, aw{};           ///< orientation of A
  alignas(64) Column bi{}, bj{}, bk{}, bw{};           ///< of B
  alignas(64) Column half_a{}, half_b{};               ///< half lengths [m]
  alignas(64) Column radius_a{}, radius_b{}, reach{};  ///< [m]
};

template <class V>
EPAFI_LANES V column(const Candidates::Column& c, std::size_t k) {
  V out;
  std::memcpy(&out, c.data() + k, sizeof out);
  return out;
}

/// As std::clamp.
template <class V>
EPAFI_LANES V clamped(const V& x, const V& half) {
  return select(x < -half, -half, select(half < x, half, x));
}

/// Contacts of capsules whose axes cross: the operations of collide_closed in their order.
struct CrossingAxes {
  const Candidates& in;
  std::uint32_t first;
  std::vector<NearCapsules>& out;

  template <int n>
  EPAFI_LANES void run() const {
    for (std::size_t g = 0; g < in.count; g += n) several<n>(g);
  }

 private:
  template <int n>
  EPAFI_LANES void several(std::size_t g) const {
    using V = typename LanesOf<n>::Real;
    const VectorsOf<V> c{column<V>(in.x, g), column<V>(in.y, g), column<V>(in.z, g)};
    const VectorsOf<V> u =
        axis<V>({column<V>(in.ai, g), column<V>(in.aj, g), column<V>(in.ak, g)}, column<V>(in.aw, g));
    const VectorsOf<V> v =
        axis<V>({column<V>(in.bi, g), column<V>(in.bj, g), column<V>(in.bk, g)}, column<V>(in.bw, g));
    const V half_a = column<V>(in.half_a, g), half_b = column<V>(in.half_b, g);
    const V radius_a = column<V>(in.radius_a, g), radius_b = column<V>(in.radius_b, g);
    const VectorsOf<V> across = u.cross(v);
    const V cosine = u.dot(v), cu = c.dot(u), cv = c.dot(v), sine2 = across.dot(across);
    const V s = clamped<V>((cu - cosine * cv) / sine2, half_a);
    const V on_b = clamped<V>(s * cosine - cv, half_b), on_a = clamped<V>(cu + on_b * cosine, half_a);
    const VectorsOf<V> p = on_a * u, d = (c + on_b * v) - p;
    const V distance = sqrt(d.dot(d)), gap = distance - radius_a - radius_b;
    const VectorsOf<V> normal{d.x / distance, d.y / distance, d.z / distance};
    const VectorsOf<V> arm = p + (radius_a + 0.5 * gap) * normal;
    const V radius = 1.0 / (1.0 / radius_a + 1.0 / radius_b);
    const MaskOf<V> crosses = (sine2 > 1e-6) & (distance > 0.0), touches = gap < column<V>(in.reach, g);
    for (int l = 0; l < n && g + static_cast<std::size_t>(l) < in.count; ++l) {
      const std::uint32_t pair = first + in.place[g + static_cast<std::size_t>(l)];
      if (crosses[l] == 0)
        out.push_back({pair, false, {}});
      else if (touches[l] != 0)
        out.push_back(
            {pair,
             true,
             {gap[l], Vec3(normal.x[l], normal.y[l], normal.z[l]), Vec3(arm.x[l], arm.y[l], arm.z[l]), radius[l], 0}});
    }
  }
  /// The z axis as Eigen's quaternion turns it: not even a sign of 0 is another.
  template <class V>
  EPAFI_LANES static VectorsOf<V> axis(const VectorsOf<V>& q, const V& w) {
    const V none{}, one = none + 1.0;
    const VectorsOf<V> z{none, none, one}, cross = q.cross(z), twice = cross + cross;
    return (z + w * twice) + q.cross(twice);
  }
};

/// Of a run of at most as many pairs as there is room for.
void collect(const World& world, std::span<const Capsule> shapes, std::span<const Pair> pairs,
             std::span<const double> reach, Candidates& out) {
  out.count = 0;
  const Quat authored(1, 0, 0, 0);
  const bool turned = world.has_orientation();
  const auto orientation = [&](Slot s) -> const Quat& { return turned ? world.orientation[s] : authored; };
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Pair& p = pairs[k];
    const Capsule& a = shapes[ShapeRef{world.shape[p.a]}.index()];
    const Capsule& b = shapes[ShapeRef{world.shape[p.b]}.index()];
    Vec3 of_b = world.position[p.b];
    if (world.cell) of_b += world.cell->shift(p.image);
    const Vec3 c = of_b - world.position[p.a];
    const double half_a = a.half_length(), half_b = b.half_length();
    const double far = half_a + half_b + a.radius + b.radius + reach[k];
    if (c.squaredNorm() > 1.000001 * far * far) continue;
    const Quat &q = orientation(p.a), &r = orientation(p.b);
    const std::size_t at = out.count++;
    out.place[at] = static_cast<std::uint32_t>(k);
    out.x[at] = c.x();
    out.y[at] = c.y();
    out.z[at] = c.z();
    out.ai[at] = q.x();
    out.aj[at] = q.y();
    out.ak[at] = q.z();
    out.aw[at] = q.w();
    out.bi[at] = r.x();
    out.bj[at] = r.y();
    out.bk[at] = r.z();
    out.bw[at] = r.w();
    out.half_a[at] = half_a;
    out.half_b[at] = half_b;
    out.radius_a[at] = a.radius;
    out.radius_b[at] = b.radius;
    out.reach[at] = reach[k];
  }
}

}  // namespace

void CapsuleSieve::take(const World& world, std::span<const Capsule> shapes, std::span<const Pair> pairs,
                        std::span<const double> reach, std::uint32_t first) {
  static thread_local Candidates candidates;
  collect(world, shapes, pairs, reach, candidates);
  best_loop<CrossingAxes>()({candidates, first, near});
}

}  // namespace epafi
