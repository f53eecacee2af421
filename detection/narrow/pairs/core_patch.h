/// @file core_patch.h  Several contact points of a capsule or cylinder with a polyhedron: its straight side or flat
/// end, clipped to the face or the edge of the polyhedron that faces it. With one point a lying capsule or a standing
/// cylinder would rock.
#pragma once
#include "detection/narrow/polyhedra/manifold.h"
#include "detection/shapes/flat_side.h"

namespace epafi {

/// The polyhedron and the core of one pair.
struct CoreAndPolyhedron {
  const PolyhedronView& polyhedron;
  Mat3 rotation;  ///< core's axes to the polyhedron's axes
  Vec3 offset;    ///< core's centre in the polyhedron's axes [m]
  const void* shape;
  FlatSide (*facing)(const void* shape, const Vec3& d);
  double size;  ///< of the smaller body [m]
};

/// As the shape says, and an end or side that leans by up to 26 degrees: soft bodies are deep with all of its points.
FlatSide leaning_side(const void* shape, FlatSide (*facing)(const void* shape, const Vec3& d), const Vec3& d);

/// Of the faces around the vertex farthest along n the one that looks most along n.
std::uint32_t face_along(const PolyhedronView& p, const Vec3& n);

/// nearest: in the polyhedron's axes relative to its centre, the normal from the polyhedron to the core.
/// Points with gap < reach along the common normal: the corners of the flat side over the face or along the edge and,
/// where none of them is the nearest (a tilted disk, a round end), the nearest point. That alone where nothing flat or
/// straight faces.
Patch core_patch(const CoreAndPolyhedron& pair, const NearestPoint& nearest, double reach, double sweep_polyhedron,
                 double sweep_core);

}  // namespace epafi
