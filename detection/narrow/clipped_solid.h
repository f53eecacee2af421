/// @file clipped_solid.h  A convex polyhedron that is cut by planes, with the volume and centroid of what is left.
/// Which side a vertex lies on is decided once per vertex, so the surface stays closed whatever rounding does; parts
/// thinner than rounding (1e-16 of the size) may vanish or stay, with a volume error of that order.
#pragma once
#include <vector>

#include "detection/shapes/convex_hull.h"

namespace epafi {

/// Points with normal . x <= offset are inside.
struct Plane {
  Vec3 normal;    ///< unit, or a difference of two unit vectors
  double offset;  ///< [m]
  double above(const Vec3& x) const { return normal.dot(x) - offset; }  ///< > 0 outside
};

struct Volume {
  double volume = 0.0;           ///< [m^3]
  Vec3 centroid = Vec3::Zero();  ///< [m]; meaningless where the volume is 0
};

/// Keeps the capacity of its lists: no allocation once the largest body was seen.
class ClippedSolid {
 public:
  std::vector<Vec3> points;

  /// Takes the polyhedron, placed by x -> rotation x + offset.
  void assign(const PolyhedronView& view, const Mat3& rotation, const Vec3& offset);
  void assign(const ClippedSolid& other);
  /// Cuts away what is outside the plane. False: nothing is left.
  bool clip(const Plane& plane);
  Volume volume() const;

 private:
  struct Crossing {
    std::uint32_t inside, outside, point;
  };
  std::uint32_t* cut_face(const std::uint32_t* begin, const std::uint32_t* end, std::uint32_t* out);
  std::uint32_t* close_cuts(std::uint32_t* out);
  std::uint32_t crossing(std::uint32_t inside, std::uint32_t outside);

  std::vector<std::uint32_t> begin_, corners_;  ///< CSR: faces, counter-clockwise seen from outside
  std::vector<double> above_;                   ///< of the plane now cut by, by point
  std::vector<Vec3> next_points_;
  std::vector<std::uint32_t> next_begin_, next_corners_;
  std::vector<std::uint32_t> new_name_;   ///< of kept points, the largest number for the others
  std::uint32_t kept_ = 0;                ///< how many are kept: the names of cuts begin there
  std::vector<Crossing> crossings_;
  std::vector<std::uint32_t> cap_next_;   ///< by cut: the cut that follows it around the plane
};

}  // namespace epafi
