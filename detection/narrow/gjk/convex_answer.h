/// @file convex_answer.h  Distance of one convex pair by a named method, for `epafi narrow` and the accuracy table.
#pragma once
#include <string_view>

#include "detection/narrow/polyhedra/polyhedra.h"

namespace epafi {

enum class ConvexMethod {
  automatic,  ///< what the pair table takes for two polyhedra: features, GJK where they are apart
  sat,        ///< the separating-axis test alone: exact while they overlap, a lower bound of the distance otherwise
  gjk_epa     ///< support functions alone, as for shapes without faces
};

/// Null where the name is none of auto, sat, gjk-epa.
const ConvexMethod* convex_method(std::string_view name);

struct ConvexAnswer {
  const char* status = "ok";  ///< ok; interval: certain only to `uncertainty`; lower-bound; flat: no volume; degenerate
  double distance = 0.0;      ///< < 0: depth [m]
  double uncertainty = 0.0;   ///< the distance lies within this of `distance` [m]
  Vec3 normal = Vec3::UnitZ();
  Vec3 witness_a = Vec3::Zero(), witness_b = Vec3::Zero();  ///< relative to the own body's position, world axes [m]
};

/// memory: of this pair, from earlier poses; makes method `automatic` faster, with the same bits.
ConvexAnswer ask(ConvexMethod method, const PolyhedronView& a, const PolyhedronView& b, const Pose& pose_a,
                 const Pose& pose_b, PairMemory* memory = nullptr);

}  // namespace epafi
