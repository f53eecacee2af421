/// @file epa.h  Penetration depth by the expanding polytope algorithm (van den Bergen 2001).
/// The depth is the smallest support h(n) of the difference A - B over all directions. Two bounds enclose it at all
/// times: h of the best direction seen (upper), the nearest facet of the polytope inside (lower). It starts from any
/// tetrahedron of the difference, so that it does not depend on GJK's last simplex. The depth is `degenerate`, never a
/// guess, when the interval does not close (cap reached, facet without area).
#pragma once
#include "detection/narrow/gjk/minkowski.h"

namespace epafi {

struct Penetration {
  enum class Status {
    converged,   ///< upper - lower <= tolerance
    flat,        ///< the difference has no volume: the depth is 0 across it, exactly
    degenerate,  ///< the interval is wider than the tolerance
  };
  Status status = Status::degenerate;
  double lower = 0.0, upper = 0.0;  ///< of the depth [m], >= 0 when the bodies overlap
  Vec3 normal = Vec3::UnitZ();      ///< unit, A to B, A's axes: moving B by upper * normal parts the bodies
  Vec3 witness_a = Vec3::Zero(), witness_b = Vec3::Zero();  ///< deepest points, A's axes [m]
  int iterations = 0;
};

inline constexpr int epa_vertex_cap = 256;  // of the polytope: smooth bodies reach 1e-10 of the size with about 100

/// tolerance: of upper - lower, relative to the pair's size.
Penetration epa(const MinkowskiDifference& difference, double tolerance = 1e-12);

}  // namespace epafi
