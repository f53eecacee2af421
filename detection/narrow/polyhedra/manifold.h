/// @file manifold.h  Contact points of two polyhedra: the facing faces, projected along the common normal and clipped
/// against each other; at most 4 points, the deepest always among them. Where only overlapping points are wanted
/// (reach 0: springs), all corners of one body that lie in a face of the other, up to Patch::most: were they exchanged
/// for others at a depth, their springs would have no potential (prisms that land flat lost 0.1 of their energy).
/// Every point carries its own gap along the common normal and lies midway between the surfaces. Its feature names a
/// vertex of A, a vertex of B or a crossing of two edges: names do not depend on which body is taken as reference, so
/// they stay while the contact does. Vertices closer than 1e-6 of the size to each other or to an edge count as on it.
#pragma once
#include <array>
#include <vector>

#include "detection/narrow/pairs/pair_query.h"
#include "detection/narrow/polyhedra/polyhedra.h"

namespace epafi {

struct PatchPoint {
  Vec3 position;  ///< midway between the surfaces, A's axes, relative to A's centre [m]
  double gap;     ///< signed distance along the common normal [m]
  Feature feature;
};

struct Patch {
  static constexpr std::size_t most = 16;
  std::array<PatchPoint, most> point;
  int count = 0;
  bool alone = false;                    ///< the pair's nearest (deepest) point alone
  std::uint32_t face_a = 0, face_b = 0;  ///< of two polyhedra: the faces that look at each other
};

/// Cosine to the normal below which a face is too steep to carry a point.
constexpr double facing_cosine = 0.05;

/// Kinds of features; together with two indices of 22 bits below the image code's byte.
enum class FeatureKind : std::uint64_t { vertex_a = 0, vertex_b = 1, edges = 2, single = 3, cell_a = 4, cell_b = 5 };
constexpr Feature make_feature(FeatureKind kind, std::uint32_t a, std::uint32_t b) {
  return static_cast<Feature>(kind) << 44 | Feature{a & 0x3fffffu} << 22 | (b & 0x3fffffu);
}

constexpr FeatureKind feature_kind(Feature f) { return static_cast<FeatureKind>(f >> 44 & 0xf); }

/// The vertex of A in a feature of kind vertex_a or edges, of B in one of kind vertex_b or edges.
constexpr std::uint32_t feature_vertex_a(Feature f) { return static_cast<std::uint32_t>(f >> 22) & 0x3fffffu; }
constexpr std::uint32_t feature_vertex_b(Feature f) { return static_cast<std::uint32_t>(f) & 0x3fffffu; }

/// Points with gap < reach; sweeps: sphere radii swept over A and B [m], already inside `reach` and the gaps given
/// back. Where the faces do not look at each other (a tip, two crossed edges) it is the one closest (deepest) point.
Patch contact_patch(const PolyhedronPair& pair, const PolyhedronDistance& distance, double reach, double sweep_a,
                    double sweep_b);

/// The pair's nearest (deepest) point, in the axes of the patch.
struct NearestPoint {
  Vec3 position;  ///< midway between the surfaces [m]
  Vec3 normal;    ///< unit, from A to B
  double gap;     ///< sweeps taken off [m]
};

/// Keeps all if they are the overlapping corners of one body and springs act there (see above), else 4.
void keep_corners(std::span<const PatchPoint> points, const Vec3& normal, double size, bool springs, Patch& out);

/// Keeps 4 of the points: the deepest, the farthest from it, the two that span the largest area with them on either
/// side. Of points that are equal to within rounding the one with the lowest feature is taken, so that a body that
/// trembles by 1e-8 of its size keeps its points. The deepest of those kept carries the least gap of all. size: of the
/// smaller body [m].
void keep_four(std::span<const PatchPoint> points, const Vec3& normal, double size, Patch& out);

/// The same for corners of flat sides, with the nearest point itself where no corner is as deep.
void keep_with_nearest(std::vector<PatchPoint>& points, const NearestPoint& nearest, double size, Patch& out);

}  // namespace epafi
