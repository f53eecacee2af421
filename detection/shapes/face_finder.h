/// @file face_finder.h  Gathers the triangles of a surface to plane faces, and moves corners into the planes of their
/// faces. A face grows from its largest triangle over sides while all corners lie within a tolerance of the plane
/// fitted to it, so that it does not creep around a curved surface.
#pragma once
#include <array>
#include <utility>

#include "detection/shapes/triangle_surface.h"

namespace epafi {

struct FacePlane {
  Vec3 normal;
  Vec3 point;
  double height(const Vec3& x) const { return normal.dot(x - point); }
};

[[nodiscard]] inline FacePlane plane_of(const TriangleSurface& s, const Triangle& t) {
  const Vec3 &a = s.vertices[t[0]], &b = s.vertices[t[1]], &c = s.vertices[t[2]];
  return {(b - a).cross(c - a).normalized(), a};
}

/// The triangles behind the sides of each, however many share a side.
class TriangleNeighbours {
 public:
  explicit TriangleNeighbours(const std::vector<Triangle>& triangles) : uses_(sorted_edge_uses(triangles)) {
    run_.resize(triangles.size());
    for (std::size_t begin = 0, end = 0; begin < uses_.size(); begin = end) {
      while (end < uses_.size() && uses_[end].edge() == uses_[begin].edge()) ++end;
      for (std::size_t k = begin; k < end; ++k) run_[uses_[k].triangle][uses_[k].side] = {begin, end};
    }
  }
  template <class F>
  void each(std::uint32_t t, const F& f) const {
    for (const auto& [begin, end] : run_[t])
      for (std::size_t k = begin; k < end; ++k)
        if (uses_[k].triangle != t) f(uses_[k].triangle);
  }

 private:
  std::vector<EdgeUse> uses_;
  std::vector<std::array<std::pair<std::size_t, std::size_t>, 3>> run_;
};

/// Gathers triangles to faces, beginning with the largest.
class FaceFinder {
 public:
  static constexpr std::uint32_t unknown = 0xffffffffu;

  /// tolerance: of the corners of a face to its plane [m]. The surface must outlive the finder.
  FaceFinder(const TriangleSurface& surface, double tolerance);

  std::vector<std::uint32_t> face;  ///< by triangle: which of the planes
  std::vector<FacePlane> planes;
  std::vector<std::uint32_t> size;  ///< of each face: its triangles

 private:
  void grow(std::uint32_t first);
  bool lies_in(const FacePlane& plane, std::uint32_t t) const;
  /// Through the members' corners, least squares.
  FacePlane fitted(const FacePlane& before) const;

  const TriangleSurface& surface_;
  TriangleNeighbours around_;
  double tolerance_;
  std::vector<std::uint32_t> members_;
};

struct CornerMoves {
  bool is_exact = true;   ///< all corners lie in their planes to rounding: none was moved
  std::size_t count = 0;  ///< corners that moved by more than rounding
  double farthest = 0.0;  ///< of them [m]
};

/// Moves corners into the planes of the faces of several triangles that meet there, where some are farther than
/// `rounding` [m] from them.
CornerMoves move_into_planes(TriangleSurface& surface, const FaceFinder& faces, double rounding);

}  // namespace epafi
