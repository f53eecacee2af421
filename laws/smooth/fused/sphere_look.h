/// @file sphere_look.h  Which pairs of a run touch, n at a time.
#pragma once
#include "laws/smooth/fused/sphere_tile.h"

namespace epafi {

/// Prefetches the bodies B of later pairs, beyond the n that are tested now.
template <int n>
EPAFI_LANES void fetch_ahead(const SpherePlaces* pair, const SphereArrays& with) {
  for (int l = 0; l < n; ++l) {  // A's lines are those of the pair before
    const BodyState& soon = with.state(pair[SphereBlocks::pairs_ahead + l].b);
    __builtin_prefetch(&soon.position);
    __builtin_prefetch(&soon.spin);
  }
}

/// Bodies of the chosen pairs into the rows from `to` on.
template <int n>
EPAFI_LANES void write_bodies(const SphereTile<n>& t, const SpherePlaces* pair, const ChosenLanes<n>& chosen,
                              char* to) {
  static_assert(sizeof(SpherePlaces) == sizeof(double));
  typename LanesOf<n>::Real places;
  std::memcpy(&places, pair, sizeof places);
  compress<n>(places, chosen, to + t.offset_of(t.bodies));
}

/// Adds those of the n pairs from `k` on that touch, or are `held` (a bit each) within the reach, as contacts from
/// number `at` on, and returns one bit for each. The normals of all n are found here: their root and division wait
/// beside the look at the next ones.
template <int n, bool wall, bool periodic>
EPAFI_LANES std::size_t look(SphereTile<n>& t, std::size_t at, const SpherePlaces* pairs, const SphereImage* images,
                             std::size_t k, const SpherePlane* plane, const SphereArrays& with, unsigned held) {
  using V = typename LanesOf<n>::Real;
  const SpherePlaces* pair = pairs + k;
  VectorsOf<V> d;
  V radii, overlap, curvature{}, distance{};
  std::size_t bits;
  if constexpr (wall) {
    read_columns([&](int l) EPAFI_INLINED { return row<n>(with.state(pair[l].a).position); }, d.x, d.y, d.z, radii);
    const Vec3 &out = plane->normal, &p = plane->point;
    d.x = out.x() * (d.x - p.x()) + out.y() * (d.y - p.y()) + out.z() * (d.z - p.z());
    bits = less_bits<n>(d.x, radii);
    if (with.reach > 0.0) bits |= held & less_bits<n>(d.x, radii + filled<n>(with.reach));
    overlap = radii - d.x;
  } else {
    read_columns(
        [&](int l) EPAFI_INLINED {  // in the fourth the sum of both instead of the difference
          const auto between = apart<n>(with.state(pair[l].a).position, with.state(pair[l].b).position);
          if constexpr (periodic)
            return between + row<n>(with.cell_size) * row<n>(images[k + static_cast<std::size_t>(l)].cells);
          else
            return between;
        },
        d.x, d.y, d.z, radii);
    d.z += filled<n>(1e-130);  // no rounding, but the normal is z where centres are one
    const V square = d.dot(d);
    bits = less_bits<n>(square, radii * radii);
    const V far = radii + filled<n>(with.reach);
    if (with.reach > 0.0) bits |= held & less_bits<n>(square, far * far);
    distance = sqrt(square);
    const V both = distance * (1.0 / (square * radii));  // over both; neither root nor division waits for the other
    d = (radii * both) * d;
    overlap = radii - distance;
    curvature = distance * both;
  }
  fetch_ahead<n>(pair, with);
  const ChosenLanes<n> chosen(bits);
  char* const to = t.row_from(at);
  compress<n>(overlap, chosen, to + t.offset_of(t.overlap));
  if constexpr (!wall) {  // the normal of a wall stands there already
    compress<n>(d.x, chosen, to + t.offset_of(t.x));
    compress<n>(d.y, chosen, to + t.offset_of(t.y));
    compress<n>(d.z, chosen, to + t.offset_of(t.z));
    compress<n>(curvature, chosen, to + t.offset_of(t.curvature));
  }
  if constexpr (periodic && !wall) compress<n>(distance, chosen, to + t.offset_of(t.distance));
  write_bodies<n>(t, pair, chosen, to);
  if constexpr (periodic) write_places<n>(static_cast<unsigned>(bits), static_cast<std::uint32_t>(k), t.pair + at);
  return bits;
}

/// The look at eight pairs.
template <int n, bool wall, bool periodic>
struct SphereLook {
  const SpherePlaces* pairs;
  const SphereImage* images;
  const SpherePlane* plane;
  EPAFI_LANES SphereLook(const SphereBlocks::Block& block, const SphereBlocks::Run& run, const SphereArrays& with)
      : pairs(block.pairs.data()), images(block.images.data()), plane(wall ? with.planes + run.plane : nullptr) {}
  EPAFI_LANES void begin(SphereTile<n>& t) const {
    if constexpr (wall) t.set_normal(-plane->normal);
  }
  /// Rows after the last pair of the run hold NaN, and do not touch.
  EPAFI_LANES unsigned eight_from(SphereTile<n>& t, std::size_t k, const SphereArrays& with, unsigned held) const {
    unsigned now = 0;
    std::size_t at = t.count;
    const auto add = [&](std::size_t l) EPAFI_INLINED {
      const std::size_t bits = look<n, wall, periodic>(t, at, pairs, images, k + l, plane, with, held >> l);
      at += n == 2 ? (bits & 1u) + (bits >> 1) : std::size_t{bit_places.count[bits]};
      now |= static_cast<unsigned>(bits) << l;
    };
    [&]<std::size_t... i>(std::index_sequence<i...>) EPAFI_INLINED { (add(i * n), ...); }  // by SSE2 no loop
    (std::make_index_sequence<SphereBlocks::pairs_per_byte / n>{});
    t.count = at;
    return now;
  }
};

/// For dt = 0: gives new contacts unloaded springs. from: see SphereSprings::choose.
void begin_contacts(SphereBlocks::Block& block, const SphereArrays& with, std::vector<std::uint32_t>& from);

}  // namespace epafi
