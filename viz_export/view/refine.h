/// @file refine.h  Curved bodies look round: each triangle becomes four on a curved patch (PN triangles, Vlachos et al.
/// 2001). Flat faces stay flat; creases stay creases, and become arcs where their corners lie on one.
#pragma once
#include "viz_export/view/mesh.h"

namespace epafi {

/// Every point of the mesh stays. New points of spheres and of rims of cylinders are exact up to the mesh's normals.
[[nodiscard]] ViewMesh refined(const ViewMesh& mesh);

}  // namespace epafi
