/// @file surface_gap.h  Gaps between two surfaces of triangles whose nodes move: every node, or every integration
/// point, of one surface against its closest-point projection on the other, g = (x - x_bar) . n (Wriggers 2006, chapter
/// 4). The projected-on surface is the first of engine/railway/gap_operator.h ("master"), the other the second: n is
/// the outward normal of the first, g < 0 inside it. Over a face n is the face's; beside it, over an edge or a corner,
/// it points from the projection to x, signed by the angle-weighted normal (Baerentzen and Aanaes 2005); so dg = n .
/// (dx - dx_bar) with the weights of the projection held is exact to first order everywhere but where the projection
/// jumps. Only candidates with |g| <= band are reported, each with the area that its site would have.
#pragma once
#include "detection/surfaces/surface_tree.h"
#include "engine/railway/gap_operator.h"

namespace epafi {

/// Which slave feature met which master triangle: the segment pairs of the method.
struct GapSite {
  std::uint32_t slave;   ///< node (node-to-surface) or triangle (surface-to-surface)
  std::uint32_t master;  ///< triangle of the first surface
  double area;           ///< of the slave surface that the candidate stands for [m^2]
};

/// Projection on the master surface, shared by both methods.
class ProjectionSurface {
 public:
  /// Triangles name nodes in the positions that every call is given; outward counter-clockwise.
  ProjectionSurface(std::span<const Vec3> positions, std::span<const Triangle> triangles);
  struct Projection {
    std::uint32_t triangle = NearestOnSurface::none;
    double gap = 0.0;                    ///< [m]
    Vec3 normal;                         ///< unit
    double weight[3] = {0.0, 0.0, 0.0};  ///< of the triangle's nodes at the projection, sum 1
  };
  /// Boxes and normals for new positions; call before `project`.
  void update(std::span<const Vec3> positions);
  Projection project(std::span<const Vec3> positions, const Vec3& x, double band) const;
  std::span<const Triangle> triangles() const { return tree_.triangles(); }

 private:
  SurfaceTree tree_;
  std::vector<std::array<std::uint32_t, 3>> neighbour_;  ///< triangle across side k, or none
  std::vector<Vec3> face_normal_, node_normal_;          ///< node_normal_: weighted by angle, not unit
};

/// Nodes of the second surface against the first.
class NodeToSurface final : public GapOperator {
 public:
  /// band: candidates farther than this on either side are left out [m], > 0.
  NodeToSurface(std::span<const Vec3> positions, std::span<const Triangle> master, std::span<const Triangle> slave,
                double band);
  void evaluate(std::span<const Vec3> positions, GapRows& out) const override { evaluate(positions, out, nullptr); }
  /// sites: of each candidate, with a third of the area of the triangles around the node.
  void evaluate(std::span<const Vec3> positions, GapRows& out, std::vector<GapSite>* sites) const;

 private:
  mutable ProjectionSurface master_;  // a cache of the positions last seen
  std::vector<Triangle> slave_;
  std::vector<std::uint32_t> nodes_;
  double band_;
};

/// Integration points of the second surface's triangles against the first: three per triangle, exact for quadratic
/// integrands, each with a third of the area. A constant pressure passes between flat surfaces whatever their meshes.
class SurfaceToSurface final : public GapOperator {
 public:
  SurfaceToSurface(std::span<const Vec3> positions, std::span<const Triangle> master, std::span<const Triangle> slave,
                   double band);
  void evaluate(std::span<const Vec3> positions, GapRows& out) const override { evaluate(positions, out, nullptr); }
  void evaluate(std::span<const Vec3> positions, GapRows& out, std::vector<GapSite>* sites) const;

 private:
  mutable ProjectionSurface master_;
  std::vector<Triangle> slave_;
  double band_;
};

/// Operator returned by GapSource::gaps_between.
std::unique_ptr<GapOperator> make_gap_operator(GapMethod method, std::span<const Vec3> nodes,
                                               std::span<const Triangle> first, std::span<const Triangle> second,
                                               double band);

}  // namespace epafi
