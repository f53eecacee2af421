/// @file triangle_mesh.h  Surface of triangles for fixed and driven bodies ("mesh" in scenes); both sides are walls.
/// Triangles are joined and gathered to plane faces (surface_join.h).
/// Body axes are the author's: the body's position is where the origin of the file comes to lie.
/// Found by a tree of boxes over the triangles, split at the median of the longest side, kept as one array; on wish by
/// a tree of oriented boxes instead.
#pragma once
#include <string>
#include <vector>

#include "detection/mass_properties.h"
#include "detection/shapes/obb_tree.h"
#include "detection/shapes/shape_concept.h"
#include "detection/shapes/surface_join.h"

namespace epafi {

/// Kind of an edge by its neighbour, seen from the front of the triangle (its vertices counter-clockwise).
enum class EdgeKind : std::uint8_t {
  open,    ///< no neighbour, or several, or one of opposite orientation
  flat,    ///< of the same face
  convex,  ///< bent away from the front
  concave  ///< bent towards the front
};

struct TriangleMesh {
  static constexpr const char* name = "mesh";
  static constexpr std::uint32_t none = 0xffffffffu;

  std::vector<Vec3> vertices;  ///< body axes [m]
  std::vector<Triangle> triangles;
  std::vector<Vec3> normals;                             ///< unit, towards the front
  std::vector<std::array<Vec3, 3>> inward;               ///< unit, in the plane, from side k to the inside
  std::vector<std::array<std::uint32_t, 3>> neighbours;  ///< triangle behind side k, or none
  std::vector<std::array<EdgeKind, 3>> edge_kinds;       ///< of side k

  std::vector<std::uint32_t> face;  ///< lowest triangle of the plane face a triangle is in
  struct Around {
    std::uint32_t closed;  ///< lowest triangle of the connected surface it is in; none: that has a rim
    std::uint32_t smooth;  ///< lowest triangle of the surface around it whose edges bend by less than acos(0.95)
    std::uint32_t gentle;  ///< the same for less than a degree
    std::uint8_t notches;  ///< bit k: at corner k the outline of the face turns inwards
  };
  std::vector<Around> around;  ///< of each triangle
  JoinReport joined;

  /// The surface need not be closed. precision: of its coordinates (surface_join.h) [m].
  static TriangleMesh from_surface(TriangleSurface surface, double precision = 0.0);
  /// Selects a tree of oriented boxes for later searches.
  void orient_boxes() { oriented_ = ObbTree(vertices, triangles); }

  static Entry entry() {
    return {
        name,
        "surface of triangles for fixed and driven bodies, both sides are walls",
        {{"file", "", "", Kind::text, {}, {}, "OBJ, STL or PLY file"},
         {"tree", "", "", Kind::text, {}, {}, "aabb (default), or obb: oriented boxes, for thin parts that lie askew"}},
        {},
        ""};
  }

  std::array<Vec3, 3> corners(std::uint32_t t) const {
    return {vertices[triangles[t][0]], vertices[triangles[t][1]], vertices[triangles[t][2]]};
  }

  /// Appends the triangles whose box overlaps `box` (body axes), ascending.
  void query(const Aabb& box, std::vector<std::uint32_t>& out) const;
  /// Calls f(t) for triangles whose boxes are within reach() of x [m]; reach() may shrink between calls.
  template <class Reach, class F>
  void each_within(const Vec3& x, const Reach& reach, const F& f) const {
    const auto distance = [&x](const Aabb& box) {
      return Vec3((box.min - x).cwiseMax(x - box.max).cwiseMax(0.0)).norm();
    };
    for (std::uint32_t k = 0; k < nodes_.size();) {
      const Node& node = nodes_[k];
      if (distance(node.box) > reach()) {
        k = node.skip;
        continue;
      }
      for (std::uint32_t i = node.begin; i < node.begin + node.count; ++i)
        if (distance(boxes_[leaves_[i]]) <= reach()) f(leaves_[i]);
      ++k;
    }
  }
  /// Appends candidates for a body at `pose` in the mesh's axes that may move by `margin` [m], ascending.
  template <class Body>
  void find_near(const Body& body, const Pose& pose, double margin, std::vector<std::uint32_t>& out) const {
    if (oriented_.empty())
      query(body.bounding_box(pose).fattened(margin), out);
    else
      oriented_.query(OrientedBox::placed(body.bounding_box({}), pose, margin), out);
  }

  double contact_radius() const { return infinity; }
  double bounding_radius() const { return radius_; }
  /// Bounds of the rotated box of the whole mesh: possibly larger than the mesh's, never smaller.
  Aabb bounding_box(const Pose& pose) const;
  /// At density 1, meaningful for a closed surface; the centre is given, the inertia is about it.
  MassProperties mass_properties() const { return surface_mass_properties(vertices, triangles); }

 private:
  struct Node {
    Aabb box;
    std::uint32_t skip;   ///< next node if this one is skipped; nodes are in depth-first order
    std::uint32_t begin;  ///< first entry of leaves_ (leaf), or unused
    std::uint32_t count;  ///< triangles of a leaf, 0: inner node
  };
  void find_neighbours();
  void find_notches();
  void find_connected();
  /// Calls f(triangles) for those that neighbours t and next with joins(t, next) connect, the lowest first.
  template <class Joins, class F>
  void each_connected(const Joins& joins, const F& f) const;
  EdgeKind kind_of(const EdgeUse& p, const EdgeUse& q) const;
  std::uint32_t build(std::vector<std::uint32_t>& order, std::uint32_t begin, std::uint32_t end);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaves_;  ///< triangles in the order of the leaves
  std::vector<Aabb> boxes_;            ///< of each triangle
  ObbTree oriented_;                   ///< empty until it is needed
  double radius_ = 0.0;
};
static_assert(SolidShape<TriangleMesh>);

/// Box in the axes of a body at `pose` that contains the world box.
Aabb box_in_body_axes(const Aabb& world, const Pose& pose);

}  // namespace epafi
