/// @file resting_patch.h  Contact points of two polyhedra that hardly move relative to each other, without a query.
/// Gaps and positions follow their features to first order in the motion since the last query, the normal follows its
/// features exactly. The error is 1e-12 of the size for a motion of `still` of it; for separated points, the motion
/// times their gap. If another axis becomes the best, or a dropped corner the deepest, gaps have errors up to twice the
/// motion. Results depend on the time of the last query, so a resting patch is state, unlike a PairCache.
#pragma once
#include "detection/narrow/polyhedra/manifold.h"
#include "engine/state/state_visitor.h"

namespace epafi {

/// Relative motion up to which a patch is kept, over the smaller body's radius. 5000 settling stones move by 1e-9 of it
/// in a step, one pair in a hundred by 4e-8 or more.
constexpr double still = 1e-6;

struct RestingPatch {
  struct Point {
    Vec3 position = Vec3::Zero();  ///< midway between the surfaces, A's axes [m]
    Vec3 slope = Vec3::Zero();     ///< change of the gap per displacement of B there, A's axes
    double gap = 0.0;              ///< [m]
    Feature feature = 0;
    std::uint32_t on_a = 0, on_b = 0;     ///< lies on a vertex of A, or of B, or where two edges cross
    std::array<std::uint16_t, 4> edge{};  ///< those edges: from, to on A, from, to on B
  };
  std::uint32_t count = 0;  ///< 0: none is known
  std::uint32_t kind = 0;   ///< SeparatingAxis::Kind of the normal, and its features
  std::uint32_t feature_a = 0, feature_b = 0;
  double reach = 0.0;                                 ///< of the query [m]
  Mat3 rotation = Mat3::Zero();                       ///< pose of the query: B's axes to A's axes
  Vec3 offset = Vec3::Zero(), normal = Vec3::Zero();  ///< A's axes
  std::array<Point, 4> point;
};

template <>
inline constexpr bool is_plain<RestingPatch> = true;  // no padding: the bytes of a checkpoint are defined
static_assert(sizeof(RestingPatch) == 8 * (2 + 1 + 9 + 3 + 3 + 4 * 10));

/// Stores the points of a query that found `patch` along `axis`; none if the normal belongs to no feature.
void keep_resting(const PolyhedronPair& pair, const SeparatingAxis& axis, const Patch& patch, double reach,
                  RestingPatch& out);

/// Computes the present points and their normal (A's axes). False if the bodies have moved too far since, or a point is
/// not within reach.
bool recall_resting(const PolyhedronPair& pair, const RestingPatch& resting, double reach, Patch& out, Vec3& normal);

}  // namespace epafi
