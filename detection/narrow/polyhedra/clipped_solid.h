/// @file clipped_solid.h  A convex polyhedron that is cut by planes, with the volume and centroid of what is left.
/// Which side a vertex lies on is decided once per vertex, so the surface stays closed whatever rounding does; parts
/// thinner than rounding (1e-16 of the size) may vanish or stay, with a volume error of that order.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "detection/shapes/convex_hull.h"

namespace epafi {

/// Points with normal . x <= offset are inside.
struct Plane {
  Vec3 normal;                                                          ///< unit, or a difference of two unit vectors
  double offset;                                                        ///< [m]
  double above(const Vec3& x) const { return normal.dot(x) - offset; }  ///< > 0 outside
};

/// Many planes, an even number of entries: after the last plane may follow one that everything is infinitely far below.
class PlaneColumns {
 public:
  void clear() { count_ = 0; }
  void append(const Plane& p);
  std::size_t size() const { return count_; }
  Plane operator[](std::size_t k) const { return {{x_[k], y_[k], z_[k]}, offset_[k]}; }

 private:
  friend class ClippedSolid;
  std::size_t count_ = 0;
  std::vector<double> x_, y_, z_, offset_;
};

/// A sum of cones over one origin, which should be in or near the solid to avoid cancellation.
struct Volume {
  Vec3 origin = Vec3::Zero();  ///< [m]
  double volume = 0.0;         ///< [m^3]
  Vec3 moment = Vec3::Zero();  ///< about the origin [m^4]

  /// The cone from the origin over a convex polygon; place(k): of the corner k.
  template <class Corners, class Place>
  void add_cone(const Corners& corners, const Place& place);
  /// The same over another origin.
  Volume about(const Vec3& other) const { return {other, volume, moment + volume * (origin - other)}; }
  /// Meaningless where the volume is 0.
  Vec3 centroid() const { return origin + moment / volume; }
};

/// Keeps the capacity of its lists: no allocation once the largest body was seen.
class ClippedSolid {
 public:
  /// Takes the polyhedron, placed by x -> rotation x + offset.
  void assign(const PolyhedronView& view, const Mat3& rotation, const Vec3& offset);
  /// Only the faces listed. The next cut must take away every vertex that has a face not listed.
  void assign(const PolyhedronView& view, std::span<const std::uint32_t> faces, const Mat3& rotation,
              const Vec3& offset);
  void assign(const ClippedSolid& other);
  /// The points in any order.
  void assign_tetrahedron(const std::array<Vec3, 4>& x);
  /// Cuts away what is outside the plane. False: nothing is left.
  bool clip(const Plane& plane);
  /// The least and the largest height of its points above each plane [m].
  void ranges(const PlaneColumns& planes, std::vector<double>& low, std::vector<double>& high) const;
  /// The solid must not be empty.
  Volume volume() const;
  std::size_t points() const { return count_; }
  std::size_t faces() const { return faces_; }
  std::span<const std::uint32_t> face(std::size_t f) const {
    return {&now_.corners[now_.begin[f]], &now_.corners[now_.begin[f + 1]]};
  }
  Vec3 point(std::size_t i) const { return {now_.x[i], now_.y[i], now_.z[i]}; }

 private:
  struct Surface {
    std::vector<double> x, y, z;                ///< of the points [m]
    std::vector<std::uint32_t> begin, corners;  ///< CSR: faces, counter-clockwise seen from outside
  };
  void make_room(std::size_t points, std::size_t faces, std::size_t corners);
  void append(const Vec3& x);
  void take_next();
  void cut();
  void keep_inside();
  std::uint32_t* cut_face(const std::uint32_t* begin, const std::uint32_t* end, std::uint32_t* out);
  std::uint32_t* close_cuts(std::uint32_t* out);
  std::uint32_t crossing(std::uint32_t inside, std::uint32_t outside);

  // Lists are longer than what is in use, which is this many:
  std::size_t count_ = 0, faces_ = 0;
  Surface now_, next_;
  std::size_t next_count_ = 0, next_faces_ = 0;
  std::vector<double> above_;  ///< of the plane now cut by, by point
  std::vector<std::uint32_t>
      new_name_;  ///< of kept points, the largest number for the others; while a body is taken, of its vertices
  std::uint32_t kept_ = 0;                ///< number of kept vertices: keys of cuts begin there
  std::vector<std::uint64_t> crossings_;  ///< inside and outside point of each cut
  std::vector<std::uint32_t> cap_next_;   ///< by cut: the cut that follows it around the plane
};

template <class Corners, class Place>
void Volume::add_cone(const Corners& corners, const Place& place) {
  if (corners.size() < 3) return;
  const Vec3 p = place(corners[0]) - origin;
  Vec3 q = place(corners[1]) - origin;
  for (std::size_t k = 2; k < corners.size(); ++k) {
    const Vec3 r = place(corners[k]) - origin;
    const double of_tetrahedron = p.dot(q.cross(r)) / 6.0;
    volume += of_tetrahedron;
    moment += 0.25 * of_tetrahedron * (p + q + r);
    q = r;
  }
}

}  // namespace epafi
