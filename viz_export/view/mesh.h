/// @file mesh.h  Surfaces as triangles with normals, for drawing. Edges bent by less than a crease look round. Surfaces
/// that are one another's scaled copies share a mesh.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "viz_export/files/body_record.h"

namespace epafi {

struct ViewMesh {
  std::vector<Eigen::Vector3f> points;   ///< body axes [m], of the copy with scale 1
  std::vector<std::uint32_t> corners;    ///< three per triangle, counter-clockwise from outside
  std::vector<Eigen::Vector3f> normals;  ///< unit, one per corner
};

/// Facets of a curved surface look round up to twice that bend, and of one without flat caps always.
[[nodiscard]] ViewMesh view_mesh(const Surface& surface);

/// Pairs of points: the edges between faces that are bent by more than a crease, and borders (page/bodies.js has the
/// same).
[[nodiscard]] std::vector<std::uint32_t> feature_edges(const ViewMesh& mesh);

/// The meshes that occur. Surfaces are told apart by their address: they must stay.
class MeshStore {
 public:
  MeshStore() = default;
  /// Curved surfaces are refined unless that many bodies have them that drawing would take long.
  explicit MeshStore(const std::vector<BodyRecord>& bodies);
  struct Copy {
    std::int32_t mesh = -1;  ///< -1: a sphere
    double scale = 1.0;
  };
  /// null: a sphere.
  Copy of(const Surface* surface);
  const std::vector<ViewMesh>& all() const { return meshes_; }

 private:
  bool refines_ = true;
  std::vector<ViewMesh> meshes_;
  std::vector<double> sizes_;  ///< of each mesh, largest coordinate [m]
  std::map<const Surface*, Copy> known_;
  std::map<std::string, std::int32_t> by_form_;  ///< form without size
};

}  // namespace epafi
