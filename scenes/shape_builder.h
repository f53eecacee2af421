/// @file shape_builder.h  From the description of a shape to the shape itself with its mass properties.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "detection/mass_properties.h"
#include "detection/shape_store.h"
#include "detection/shapes/mesh_file.h"
#include "scenes/scene.h"
#include "viz_export/files/body_origin.h"

namespace epafi {

/// A shape in the store with the mass properties of its body.
struct BuiltShape {
  ShapeRef ref{};
  double volume = 0.0;   ///< [m^3]; 0 for shapes that only fixed and driven bodies may have
  PrincipalFrame frame;  ///< of the body: moments at density 1, principal to author's axes
  double radius = 0.0;   ///< of the bounding sphere about the body's centre [m], infinite for a half-space
  bool is_sphere = false;
  bool is_solid = true;  ///< may move freely
  double mass = 0.0;     ///< given by the scene [kg]; frame.moments are then whole ones, no density is needed
};

/// Builds each (shape, size factor) once; of spheres those of the first thousand sizes, beyond that each has its own
/// and nothing is kept to find it again. Geometry that cannot be built (not convex, no volume, not closed) is a
/// SceneError at the place of the shape.
class ShapeBuilder {
 public:
  ShapeBuilder(const Scene& scene, ShapeStore& store) : scene_(scene), store_(store) {}
  /// size: factor of all lengths, > 0.
  BuiltShape build(std::size_t shape, double size = 1.0);
  /// Remarks about geometry that can be used but may not be meant (an open mesh, say).
  const std::vector<Problem>& warnings() const { return warnings_; }
  /// Origins of the shapes built so far, except spheres.
  const ShapeOrigins& origins() const { return origins_; }

 private:
  BuiltShape build_new(const ShapeSpec& spec, double size);
  BuiltShape build_clump(const ShapeSpec& spec, double size);
  BuiltShape build_hollow(const ShapeSpec& spec, double size);
  BuiltShape build_wheels(const ShapeSpec& spec);
  BuiltShape build_hull(const ShapeSpec& spec, double size);
  BuiltShape build_mesh(const ShapeSpec& spec, double size);
  BuiltShape build_solid(const ShapeSpec& spec, double size);
  void warn_of(const ShapeSpec& spec, const MeshReport& report);

  const Scene& scene_;
  ShapeStore& store_;
  std::map<std::pair<std::size_t, double>, BuiltShape> built_;
  std::vector<Problem> warnings_;
  ShapeOrigins origins_;
};

}  // namespace epafi
