/// @file gjk.h  Distance of two convex bodies (Gilbert, Johnson and Keerthi 1988; sub-distance by signed volumes,
/// Montanari, Petrinic and Barbieri 2017). All tolerances are relative to the pair.
/// Error: the distance lies in [lower, upper]; both bounds are computed, not estimated. Fails to separate bodies closer
/// than about 1e-14 of their size: then it says `overlapping` and the depth decides.
#pragma once
#include <array>

#include "detection/narrow/gjk/minkowski.h"

namespace epafi {

/// Vertices whose hull holds the closest point, with its barycentric weights.
struct Simplex {
  std::array<MinkowskiVertex, 4> vertex;
  std::array<double, 4> weight{};
  int count = 0;
};

struct GjkResult {
  enum class Status {
    separated,    ///< distance in [lower, upper], upper - lower <= tolerance
    beyond,       ///< lower > the limit that was asked for: nothing else is known
    overlapping,  ///< the cores intersect or are closer than rounding can tell
    capped        ///< separated by at least lower, but the interval is wider than the tolerance
  };
  Status status = Status::overlapping;
  double lower = 0.0, upper = 0.0;  ///< of the distance [m]
  Vec3 normal = Vec3::UnitZ();      ///< unit, from A to B, A's axes: the direction that certifies `lower`
  Vec3 witness_a = Vec3::Zero(), witness_b = Vec3::Zero();  ///< closest points, A's axes, relative to A's centre [m]
  Simplex simplex;
  int iterations = 0;
};

struct GjkOptions {
  double limit = infinity;    ///< stop as soon as the distance is known to exceed this [m]
  double tolerance = 1e-15;   ///< upper - lower, relative to the pair's size
  Vec3 guess = Vec3::Zero();  ///< direction from A to B to begin with, A's axes; zero: the centres
};

inline constexpr int gjk_cap =
    64;  // polyhedra end by exact repetition, mostly below 12; of 1e6 smooth pairs none needs more than 55

GjkResult gjk(const MinkowskiDifference& difference, const GjkOptions& options = {});

/// Point of the simplex closest to the origin; drops the vertices it does not need. Exposed for its test.
/// contains_origin is set when a tetrahedron holds the origin.
Vec3 closest_to_origin(Simplex& simplex, bool& contains_origin);

}  // namespace epafi
