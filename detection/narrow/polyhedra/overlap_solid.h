/// @file overlap_solid.h  The overlap of two polyhedra as a solid, and the faces of both that matter for it.
/// Let d be its thickness along an axis n from A to B. No point of it is deeper than d below either surface, and the
/// nearest point of A's surface is at most 2 d below A's farthest along n, so its face has a vertex that high.
/// Therefore the faces around the vertices within 2 d suffice: eight to ten of 30 for stones of a settled pile.
#pragma once
#include <vector>

#include "detection/narrow/polyhedra/clipped_solid.h"
#include "detection/narrow/polyhedra/polyhedra.h"

namespace epafi {

/// The faces of one body that can bound the overlap, or be the nearest to a point of it.
struct Layer {
  std::vector<std::uint32_t> faces;
  PlaneColumns planes;              ///< of these faces, in A's axes
  std::vector<char> done;           ///< the solid was cut by this plane, or begun with it
  std::vector<double> low, high;    ///< of the solid above each plane [m]
  std::vector<std::uint64_t> bits;  ///< faces as bits, while they are collected
};

struct OverlapSolid {
  ClippedSolid solid;  ///< in A's axes, relative to A's centre
  Layer a, b;
};

/// False where nothing is left. axis: with the features it belongs to; any axis gives the overlap, one along which it
/// is thin gives it soon.
bool intersect(const PolyhedronPair& pair, const SeparatingAxis& axis, OverlapSolid& out);

}  // namespace epafi
