/// @file mesh_ridge.h  Contacts at convex edges and corners of a mesh that no triangle knows of. A body that overlaps
/// both sides of a ridge leaves each triangle on a way of its own that the other bars: each would leave the contact to
/// the other (1 of 80 boxes less than a hundredth of their size inside a hull's surface). The way out of both is that
/// out of their convex hull.
#pragma once
#include "detection/narrow/mesh_contact.h"
#include "detection/narrow/minkowski.h"

namespace epafi {

/// An overlap with triangle t that was left to others, because those around `point` bar its direction.
struct BarredTriangle {
  std::uint32_t triangle;
  Vec3 point;  ///< of the triangle [m]
};

/// A convex core and the sphere swept over it, in the mesh's axes.
struct CoreNearMesh {
  ConvexRef core;
  double sweep;
  Pose pose;
  double reach, tolerance;  ///< [m]
};

/// Appends a contact for every barred triangle around whose point nobody spoke. spoke[k]: triangles[k] gave a contact.
void collide_ridges(const CoreNearMesh& body, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                    std::span<const char> spoke, std::span<const BarredTriangle> barred, std::vector<MeshPoint>& out,
                    ContactSink& sink);

}  // namespace epafi
