/// @file overlap_cells.h  Contacts of two polyhedra as the cells of their overlap volume (potential contact, Munjiza
/// 2004). Each body carries the field phi(x) = depth of x below its surface, the least over its faces. The overlap P =
/// A and B has the potential 1/2 of the integral over P of phi_A + phi_B, a function of the poses alone with a
/// continuous gradient: forces that follow it conserve energy whatever faces, edges and corners do. phi is linear where
/// one face is nearest; such a cell of volume V and depth z at its centroid is one contact: normal of the face, point
/// at the centroid, overlap delta = 2 z, area A = V/(2 delta) (a flat slab has its thickness and half its face, the
/// other half comes from the other body). Force A delta and energy 1/2 A delta^2, times a stiffness per area, are its
/// part exactly. A half-space gives its own field alone, with the whole area. Rounding radii are not seen.
#pragma once
#include "detection/narrow/pairs/convex_pairs.h"
#include "detection/narrow/polyhedra/clipped_solid.h"

namespace epafi {

/// Data by which cells become contacts.
struct CellPlacing {
  double radius;  ///< effective [m]
  Mat3 to_world;  ///< turns A's axes into the world's
};

/// Cells of both bodies; nothing where they do not overlap. axis: see intersect(). The form found, for the next step.
OverlapForm collide_volumes(const PolyhedronPair& pair, const SeparatingAxis& axis, const CellPlacing& placing,
                            ContactSink& sink);

/// The same, bit by bit, where the overlap still has this form, with no need for an axis; nothing and false where not.
bool collide_form(const PolyhedronPair& pair, const OverlapForm& form, const CellPlacing& placing, ContactSink& sink);

/// The part of A below a plane: `up` its outward normal in A's axes, A's centre at `height` above it [m].
void collide_volume_with_plane(const PolyhedronView& a, const Vec3& up, double height, const Mat3& rotation,
                               double radius, ContactSink& sink);

}  // namespace epafi
