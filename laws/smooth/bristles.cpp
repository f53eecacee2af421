#include "laws/smooth/bristles.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/lanes/targets.h"
#include "laws/smooth/fused/sphere_lanes.h"

namespace epafi {

namespace {

/// Half as many bristles, twice as wide. The sum of two loads on twice the stiffness never holds more energy than they
/// did.
void merge(Bristles& row) {
  for (double* load : {row.along, row.across}) {
    for (int i = 0; i < Bristles::count / 2; ++i) load[i] = load[2 * i] + load[2 * i + 1];
    std::fill(load + Bristles::count / 2, load + Bristles::count, 0.0);
  }
  row.width *= 2.0;
  row.share *= 0.5;
}

/// Twice as many, half as wide: the same energy. Only where the outer half is idle.
void split(Bristles& row) {
  for (double* load : {row.along, row.across})
    for (int i = Bristles::count - 1; i >= 0; --i) load[i] = 0.5 * load[i / 2];
  row.width *= 0.5;
  row.share *= 2.0;
}

/// Bristles outside the new radius go, the one at its edge becomes as much softer.
void shrink(Bristles& row, double share) {
  const int edge = static_cast<int>(share);
  for (double* load : {row.along, row.across}) {
    if (edge < Bristles::count) load[edge] *= (share - edge) / std::min(row.share - edge, 1.0);
    for (int i = edge + 1; i < Bristles::count && i < row.share; ++i) load[i] = 0.0;
  }
}

/// One displacement of all bristles. Sums are of all, where the edge counts as a whole bristle.
struct Stretch {
  Bristles& row;
  double along, across, most;  ///< displacement [m]; load of the whole row [N]
  double *squares, *limits;    ///< of the loads [N^2], [N]; Bristles::count

  template <int n>
  EPAFI_LANES void run() const {
    using V = typename LanesOf<n>::Real;
    const double share = row.share, third = 1.0 / (3.0 * share * share), all = most * 1.5 / share;
    V inner = V{};
    for (int l = 0; l < n; ++l) inner[l] = l;
    unsigned sliding = 0;  // groups, by bits: GCC 12 makes a mask of one lane of a branch here
    for (std::size_t g = 0; g < row_groups<n>(share); ++g, inner += static_cast<double>(n)) {
      // the normal load is the integral of 1 - (x/s)^2 over the part that is inside
      const V part = at_most<n>(at_least<n>(share - inner, 0.0), 1.0), outer = inner + part;
      const V limit = all * (part - (outer * outer * outer - inner * inner * inner) * third);
      const V u = read<n>(row.along, g) + (row.width * along) * part;
      const V v = read<n>(row.across, g) + (row.width * across) * part;
      const V square = u * u + v * v;
      sliding |= static_cast<unsigned>(less_bits<n>(limit * limit, square) != 0) << g;
      write<n>(row.along, g, u);
      write<n>(row.across, g, v);
      write<n>(squares, g, square);
      write<n>(limits, g, limit);
    }
    for (; sliding != 0; sliding &= sliding - 1u) slide<n>(static_cast<std::size_t>(std::countr_zero(sliding)));
    const int edge = static_cast<int>(share);
    if (share > edge) squares[edge] /= share - edge;
    row.load_along = sum<n>(row.along, share);
    row.load_across = sum<n>(row.across, share);
    row.energy = sum<n>(squares, share) * (0.5 / row.width);
  }

 private:
  template <int n>
  EPAFI_LANES void slide(std::size_t g) const {
    using V = typename LanesOf<n>::Real;
    const V length = sqrt(at_least<n>(read<n>(squares, g), 1e-300));
    const V scale = at_most<n>(read<n>(limits, g) / length, 1.0);
    const V u = scale * read<n>(row.along, g), v = scale * read<n>(row.across, g);
    write<n>(row.along, g, u);
    write<n>(row.across, g, v);
    write<n>(squares, g, u * u + v * v);
  }
  template <int n>
  EPAFI_LANES static std::size_t row_groups(double share) {
    return (static_cast<std::size_t>(std::ceil(share)) + 7) / 8 * LaneSum<n>::parts;
  }
  template <int n>
  EPAFI_LANES static typename LanesOf<n>::Real read(const double* column, std::size_t g) {
    typename LanesOf<n>::Real x;
    std::memcpy(&x, column + g * n, sizeof x);
    return x;
  }
  template <int n>
  EPAFI_LANES static void write(double* column, std::size_t g, typename LanesOf<n>::Real x) {
    std::memcpy(column + g * n, &x, sizeof x);
  }
  template <int n>
  EPAFI_LANES static double sum(const double* column, double share) {
    LaneSum<n> all;
    all.add(row_groups<n>(share), [column](std::size_t g) EPAFI_INLINED { return read<n>(column, g); });
    return all.total();
  }
};

}  // namespace

FrictionResponse pull_bristles(const SlipStep& step, double stiffness, double limit, const Bristles& before,
                               Bristles& now) {
  if (!(stiffness > 0.0)) {
    now = Bristles{};
    return {};
  }
  now = before;
  if (!(now.width > 0.0)) now.width = stiffness / (0.75 * Bristles::count);
  while (stiffness > now.width * Bristles::count) merge(now);
  while (stiffness < 0.25 * now.width * Bristles::count && now.share <= 0.5 * Bristles::count) split(now);
  const double share = stiffness / now.width;
  if (share < now.share) shrink(now, share);
  now.share = share;
  now.axis = turn_load(now.axis, step.normal, step.twist);
  if (!(now.axis.squaredNorm() > 0.0)) now.axis = step.normal.unitOrthogonal();
  const Vec3 second = step.normal.cross(now.axis);
  const Vec3 old = now.load_along * now.axis + now.load_across * second;
  alignas(64) double squares[Bristles::count], limits[Bristles::count];
  best_loop<Stretch>()({now, step.displacement.dot(now.axis), step.displacement.dot(second), limit, squares, limits});
  const Vec3 load = now.load_along * now.axis + now.load_across * second;
  return {load, now.energy, 0.5 * (old + load).dot(step.displacement)};
}

}  // namespace epafi
