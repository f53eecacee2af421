/// @file cylinder_distance.h  Signed distance of two right circular cylinders, of which one may be a segment or a
/// point. Along a unit vector n the gap is n.c - r_a |n x u| - h_a |n.u| - r_b |n x v| - h_b |n.v|: axes u and v, c
/// from centre to centre; the signed distance is its largest value over n. It lies where an end of one meets the
/// other, where two sides cross, where a side meets a rim or where two rims meet. The first two are closed forms, a
/// side and a rim are Newton's method in one angle, two rims in two. Each is taken where its two points lie on what
/// it assumes: apart, this is the distance, because only one local maximum is above 0. Overlapping, it is the depth
/// where no other direction can be shallower (`Hold`); elsewhere the caller asks the exact method. Nothing is
/// remembered.
#pragma once
#include "detection/narrow/gjk/common_normal.h"

namespace epafi {

template <class S>
concept CylinderShape = ConvexShape<S> && requires(const S& s) {
  { s.cylinder_core() } -> std::same_as<CylinderCore>;
};

/// rotation, offset: B's axes and centre in A's; the axes of both are their z. limit: gaps beyond are not wanted [m].
CommonNormal cylinder_distance(const CylinderCore& a, const CylinderCore& b, const Mat3& rotation, const Vec3& offset,
                               double limit);

}  // namespace epafi
