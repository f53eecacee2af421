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
  static constexpr std::size_t room = 256, spare = 8;
  using Column = std::array<double, room + spare>;
  std::size_t count = 0;
  std::array<std::uint32_t, room + spare> place;
  alignas(64) Column x{}, y{}, z{};              ///< from the centre of A to that of B [m]
  alignas(64) Column ax{}, ay{}, az{};           ///< axis of A
  alignas(64) Column bi{}, bj{}, bk{}, bw{};     ///< orientation of B
  alignas(64) Column half_a{}, half_b{}, far{};  ///< half lengths; sum of radii and the reach [m]
};

template <class V>
EPAFI_LANES V column(const Candidates::Column& c, std::size_t k) {
  V out;
  std::memcpy(&out, c.data() + k, sizeof out);
  return out;
}

template <class V>
EPAFI_LANES V clamped(const V& x, const V& half) {
  return max(V{} - half, min(half, x));
}

/// The nearest points of two segments (Ericson 2005, 5.1.9), as the closed form takes them. Nearly parallel axes are
/// not told apart here.
struct NearAxes {
  const Candidates& in;
  std::vector<std::uint32_t>& out;

  template <int n>
  EPAFI_LANES void run() const {
    using V = typename LanesOf<n>::Real;
    constexpr double slack = 1.0 + 1e-6;  // of a squared distance that is known to 1e-10
    std::uint32_t* to = out.data();
    for (std::size_t g = 0; g < in.count; g += n) {
      const VectorsOf<V> c{column<V>(in.x, g), column<V>(in.y, g), column<V>(in.z, g)};
      const VectorsOf<V> u{column<V>(in.ax, g), column<V>(in.ay, g), column<V>(in.az, g)};
      const V i = column<V>(in.bi, g), j = column<V>(in.bj, g), k = column<V>(in.bk, g), w = column<V>(in.bw, g);
      const VectorsOf<V> v{2.0 * (i * k + w * j), 2.0 * (j * k - w * i), 1.0 - 2.0 * (i * i + j * j)};
      const V half_a = column<V>(in.half_a, g), half_b = column<V>(in.half_b, g), far = column<V>(in.far, g);
      const V cosine = u.dot(v), cu = c.dot(u), cv = c.dot(v), sine2 = 1.0 - cosine * cosine;
      constexpr double parallel = 1e-5;
      const V some = max(sine2, V{} + parallel);
      const V first = clamped<V>((cu - cosine * cv) / some, half_a);
      const V t = clamped<V>(first * cosine - cv, half_b);
      const V s = clamped<V>(cu + t * cosine, half_a);
      const VectorsOf<V> apart = c + t * v - s * u;
      const V square = apart.dot(apart), limit = slack * (far * far);
      for (int l = 0; l < n && g + static_cast<std::size_t>(l) < in.count; ++l) {
        *to = in.place[g + static_cast<std::size_t>(l)];  // no branch: the next one overwrites what is not kept
        to += square[l] <= limit[l] || sine2[l] <= parallel;
      }
    }
    out.resize(static_cast<std::size_t>(to - out.data()));
  }
};

Vec3 axis_of(const Quat& q) {
  return {2.0 * (q.x() * q.z() + q.w() * q.y()), 2.0 * (q.y() * q.z() - q.w() * q.x()),
          1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y())};
}

/// Of a run of at most as many pairs as there is room for.
void collect(const World& world, std::span<const Capsule> shapes, std::span<const Pair> pairs, double reach,
             Candidates& out) {
  out.count = 0;
  Slot last = no_slot;
  const Quat authored(1, 0, 0, 0);
  const bool turned = world.has_orientation();
  const auto orientation = [&](Slot s) -> const Quat& { return turned ? world.orientation[s] : authored; };
  Vec3 axis = Vec3::Zero();
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Pair& p = pairs[k];
    if (p.a != last) axis = axis_of(orientation(p.a));
    last = p.a;
    const Capsule& a = shapes[ShapeRef{world.shape[p.a]}.index()];
    const Capsule& b = shapes[ShapeRef{world.shape[p.b]}.index()];
    Vec3 c = world.position[p.b] - world.position[p.a];
    if (world.cell) c += world.cell->shift(p.image);
    const Quat& q = orientation(p.b);
    const std::size_t at = out.count;
    out.place[at] = static_cast<std::uint32_t>(k);
    out.x[at] = c.x();
    out.y[at] = c.y();
    out.z[at] = c.z();
    out.ax[at] = axis.x();
    out.ay[at] = axis.y();
    out.az[at] = axis.z();
    out.bi[at] = q.x();
    out.bj[at] = q.y();
    out.bk[at] = q.z();
    out.bw[at] = q.w();
    out.half_a[at] = a.half_length();
    out.half_b[at] = b.half_length();
    out.far[at] = a.radius + b.radius + reach;
    const double balls = out.half_a[at] + out.half_b[at] + out.far[at];
    out.count += c.squaredNorm() <= 1.000001 * balls * balls;
  }
}

}  // namespace

std::span<const std::uint32_t> near_capsules(const World& world, std::span<const Capsule> shapes,
                                             std::span<const Pair> pairs, double reach) {
  static thread_local Candidates candidates;
  static thread_local std::vector<std::uint32_t> near, all;
  const auto sieve = best_loop<NearAxes>();
  all.clear();
  for (std::size_t first = 0; first < pairs.size(); first += Candidates::room) {
    const std::size_t count = std::min(Candidates::room, pairs.size() - first);
    collect(world, shapes, pairs.subspan(first, count), reach, candidates);
    near.resize(candidates.count + 1);
    sieve({candidates, near});
    for (const std::uint32_t k : near) all.push_back(static_cast<std::uint32_t>(first) + k);
  }
  return all;
}

}  // namespace epafi
