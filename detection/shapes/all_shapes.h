/// @file all_shapes.h  The list of shapes: include the header, add the name.
#pragma once
#include "detection/shapes/box.h"
#include "detection/shapes/capsule.h"
#include "detection/shapes/clump.h"
#include "detection/shapes/cone.h"
#include "detection/shapes/convex_hull.h"
#include "detection/shapes/cylinder.h"
#include "detection/shapes/ellipsoid.h"
#include "detection/shapes/half_space.h"
#include "detection/shapes/rail_profile.h"
#include "detection/shapes/solid_parts.h"
#include "detection/shapes/sphere.h"
#include "detection/shapes/superquadric.h"
#include "detection/shapes/triangle_mesh.h"
#include "detection/shapes/tube.h"
#include "detection/shapes/wheel_profile.h"

namespace epafi {

template <class... S>
struct ShapeList {
  static constexpr std::size_t size = sizeof...(S);
};

using AllShapes = ShapeList<Sphere, HalfSpace, Box, ConvexHull, Capsule, Cylinder, Ellipsoid, Superquadric,
                            TriangleMesh, Clump, SolidParts, WheelProfile, RailProfile, Tube, Cone>;

}  // namespace epafi
