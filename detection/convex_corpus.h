/// @file convex_corpus.h  Pairs of convex polyhedra with exact signed distances, in the CXP1 format
/// (tests/data/README.md).
#pragma once
#include <string>
#include <vector>

#include "detection/shapes/convex_hull.h"
#include "engine/units/random.h"

namespace epafi {

struct CorpusBody {
  Vec3 centre;                                    ///< [m]
  std::vector<Vec3> vertices;                     ///< relative to centre
  std::vector<std::vector<std::uint32_t>> faces;  ///< counter-clockwise triangles
};

struct CorpusPair {
  std::string category;
  CorpusBody a, b;
  double size = 0.0;      ///< bounding radius of the smaller body [m]
  double distance = 0.0;  ///< exact, < 0: penetration depth [m]
  Vec3 normal, witness_a, witness_b;

  /// Separation along n by brute force in extended precision: min over B of n.x minus max over A.
  long double separation(const Vec3& n) const;
  /// Smallest length that doubles resolve: 1e-12 of the smaller body and 1e-15 of the largest coordinate [m].
  double resolution() const;
  /// Poses of B while the pair oscillates about its pose: successive ones are up to 1e-3 of the size apart, 0.7e-3 on
  /// average, and rotated so that no point of B moves by more than that in addition.
  std::vector<Pose> moving_poses(std::size_t count, Random& random) const;
};

/// Throws FileError where the file cannot be read, SceneError with the byte where its content breaks off or is no
/// corpus.
std::vector<CorpusPair> read_corpus(const std::string& path);

}  // namespace epafi
