/// @file manifold.h  Contact manifold of two polyhedra: the facing faces, projected along the common normal and clipped
/// against each other; at most 4 points, including the deepest. With reach 0 (smooth laws without adhesion) all corners
/// of one body inside a face of the other are kept, up to Patch::most: replacing points at a finite depth would leave
/// their springs without a potential (prisms that land flat would lose 0.1 of their energy). Every point has its own
/// gap along the common normal and lies midway between the surfaces. Its feature names a vertex of A, a vertex of B or
/// a crossing of two edges. Names do not depend on which body is the reference, so they persist with the contact.
/// Vertices closer than 1e-6 of the size to each other or to an edge count as on it.
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
  bool alone = false;                    ///< contains only the nearest (deepest) point
  std::uint32_t face_a = 0, face_b = 0;  ///< of two polyhedra: the facing faces
};

/// Cosine to the normal below which a face is too steep for a contact point.
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

/// Points with gap < reach. sweep_a, sweep_b: sphere radii swept over A and B [m], already contained in `reach` and in
/// the returned gaps. Without facing faces (a tip, two crossed edges): the nearest (deepest) point alone.
Patch contact_patch(const PolyhedronPair& pair, const PolyhedronDistance& distance, double reach, double sweep_a,
                    double sweep_b);

/// The pair's nearest (deepest) point, in the axes of the patch.
struct NearestPoint {
  Vec3 position;  ///< midway between the surfaces [m]
  Vec3 normal;    ///< unit, from A to B
  double gap;     ///< sweeps taken off [m]
};

bool are_corners_of_one(std::span<const PatchPoint> points);

/// Keeps all points if they are overlapping corners of one body under a smooth law (see above), else 4.
void keep_corners(std::span<const PatchPoint> points, const Vec3& normal, double size, bool springs, Patch& out);

/// Keeps 4 of the points: the deepest, the farthest from it, and the two that span the largest area on either side. Of
/// points that are equal within rounding, the one with the lowest feature is kept, so that vibrations of 1e-8 of the
/// size do not change the selection. The deepest of them gets the least gap of all. size: of the smaller body [m].
void keep_four(std::span<const PatchPoint> points, const Vec3& normal, double size, Patch& out);

/// The same for corners of flat sides, plus the nearest point if no corner is as deep.
void keep_with_nearest(std::vector<PatchPoint>& points, const NearestPoint& nearest, double size, bool springs,
                       Patch& out);

}  // namespace epafi
